//! A table of weights in one dimension: discrete indices, or a piecewise constant density.

use super::cdf::{cell_of, fill_cdf, find_cell, position_in_cell};
use super::weights::{WeightError, checked_sum};
use crate::hash::ONE_MINUS_EPSILON;

/// Weights to sample an index from, or a position in [0, 1) with piecewise constant density.
///
/// Probabilities are differences of single-precision cumulative shares, so `pmf` and `pdf` are exactly
/// those of `sample`. A weight below about 10⁻⁷ of the sum may have no probability; for many weights of
/// very different sizes use an [`AliasTable`](crate::AliasTable).
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution1D {
    cdf: Vec<f32>,
    sum: f64,
}

impl Distribution1D {
    /// A table of `weights`, summed in double precision.
    ///
    /// # Errors
    /// [`WeightError`], also where all weights are zero.
    pub fn new(weights: &[f32]) -> Result<Self, WeightError> {
        if checked_sum(weights)? <= 0.0 {
            return Err(WeightError::ZeroSum);
        }
        let mut cdf = vec![0.0; weights.len() + 1];
        let sum = fill_cdf(weights, &mut cdf);
        Ok(Self { cdf, sum })
    }

    /// The number of weights.
    #[inline]
    #[must_use]
    pub fn len(&self) -> usize {
        self.cdf.len() - 1
    }

    /// Always false: a table has at least one weight.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The sum of the weights.
    #[inline]
    #[must_use]
    pub fn sum(&self) -> f64 {
        self.sum
    }

    /// The integral over [0, 1] of the step function whose values are the weights.
    #[inline]
    #[must_use]
    pub fn integral(&self) -> f64 {
        self.sum / self.len() as f64
    }

    /// The probability of `index`; zero beyond the end.
    #[inline]
    #[must_use]
    pub fn pmf(&self, index: usize) -> f32 {
        match self.cdf.get(index..).and_then(|rest| rest.get(..2)) {
            Some(edges) => edges[1] - edges[0],
            None => 0.0,
        }
    }

    /// An index with probability [`pmf`](Self::pmf), from one uniform number.
    #[inline]
    #[must_use]
    pub fn sample(&self, uniform: f32) -> usize {
        find_cell(&self.cdf, uniform)
    }

    /// An index, and the rest of the uniform number: uniform in [0, 1) again, but with fewer digits the
    /// less probable the index is.
    #[inline]
    #[must_use]
    pub fn sample_reuse(&self, uniform: f32) -> (usize, f32) {
        let index = find_cell(&self.cdf, uniform);
        let (start, end) = (self.cdf[index], self.cdf[index + 1]);
        let rest = (uniform - start) / (end - start);
        (index, rest.clamp(0.0, ONE_MINUS_EPSILON))
    }

    /// A position in [0, 1) with density [`pdf`](Self::pdf), from one uniform number.
    #[inline]
    #[must_use]
    pub fn sample_position(&self, uniform: f32) -> f32 {
        let (index, rest) = self.sample_reuse(uniform);
        position_in_cell(index, rest, self.len())
    }

    /// The density at `position`; zero outside [0, 1).
    #[inline]
    #[must_use]
    pub fn pdf(&self, position: f32) -> f32 {
        match cell_of(position, self.len()) {
            Some(index) => self.pmf(index) * self.len() as f32,
            None => 0.0,
        }
    }

    /// The uniform number that [`Self::sample_position`] maps to a position, which is clamped to [0, 1).
    #[inline]
    #[must_use]
    pub fn invert(&self, position: f32) -> f32 {
        let position = position.clamp(0.0, ONE_MINUS_EPSILON);
        let index = cell_of(position, self.len()).unwrap_or(0);
        let rest = position * self.len() as f32 - index as f32;
        let (start, end) = (self.cdf[index], self.cdf[index + 1]);
        (start + rest * (end - start)).clamp(0.0, ONE_MINUS_EPSILON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::{ChiSquare, TestRng, chi2_discrete};

    const WEIGHTS: [f32; 7] = [0.0, 1.0, 0.5, 0.0, 3.0, 2.5, 0.0];

    #[test]
    fn indices_follow_the_weights() {
        let table = Distribution1D::new(&WEIGHTS).unwrap();
        let mut random = TestRng::new(1);
        let mut counts = [0_u64; 7];
        for _ in 0..100_000 {
            counts[table.sample(random.next_f32())] += 1;
        }
        chi2_discrete(&counts, &WEIGHTS.map(f64::from)).assert();
        assert_eq!((counts[0], counts[3], counts[6]), (0, 0, 0));
        assert_eq!((table.sample(0.0), table.sample(ONE_MINUS_EPSILON)), (1, 5));
        for (index, weight) in WEIGHTS.iter().enumerate() {
            assert!((table.pmf(index) - weight / 7.0).abs() < 1e-7);
        }
        assert_eq!((table.pmf(7), table.pmf(usize::MAX)), (0.0, 0.0));
    }

    #[test]
    fn what_is_left_is_uniform() {
        let table = Distribution1D::new(&WEIGHTS).unwrap();
        let rest = |random: &mut TestRng| Some(table.sample_reuse(random.next_f32()).1);
        ChiSquare::default().line((0.0, 1.0), rest, |_| 1.0).assert();
    }

    #[test]
    fn positions_follow_the_density() {
        let table = Distribution1D::new(&WEIGHTS).unwrap();
        let draw = |random: &mut TestRng| Some(table.sample_position(random.next_f32()));
        ChiSquare::default().line((0.0, 1.0), draw, |x| table.pdf(x)).assert();
        for step in 0..1000 {
            let uniform = step as f32 / 1000.0;
            assert!((table.invert(table.sample_position(uniform)) - uniform).abs() < 1e-6);
        }
        assert_eq!((table.pdf(-0.1), table.pdf(1.0), table.pdf(f32::NAN)), (0.0, 0.0, 0.0));
    }

    #[test]
    fn every_sample_has_a_density() {
        // Many narrow cells, half of them empty: rounding must not leave a cell.
        let weights: Vec<f32> = (0..10_007).map(|index| (index % 2) as f32).collect();
        let table = Distribution1D::new(&weights).unwrap();
        let mut random = TestRng::new(2);
        for _ in 0..200_000 {
            assert!(table.pdf(table.sample_position(random.next_f32())) > 0.0);
        }
    }

    #[test]
    fn bad_weights_are_refused() {
        assert_eq!(Distribution1D::new(&[]), Err(WeightError::Empty));
        assert_eq!(Distribution1D::new(&[0.0, 0.0]), Err(WeightError::ZeroSum));
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            let result = Distribution1D::new(&[1.0, bad]);
            assert_eq!(result, Err(WeightError::Invalid { index: 1 }));
        }
        let huge = Distribution1D::new(&[f32::MAX; 4]).unwrap();
        assert_eq!(huge.pmf(3), 0.25);
    }
}
