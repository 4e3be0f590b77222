//! Reconstruction filters to sample from, also those with negative lobes.

use super::piecewise::Distribution1D;
use super::weights::WeightError;
use glam::Vec2;

/// Cells of the table: steps of 1/128 pixel for a radius of four.
const CELL_COUNT: usize = 1024;

/// A filter on [−radius, radius] as a table that is sampled by its magnitude.
///
/// Filter importance sampling (Ernst, Stamminger and Greiner, 2006): the weight of every sample has
/// the same magnitude, and the sign of the filter where it lies.
#[derive(Clone, Debug, PartialEq)]
pub struct TabulatedFilter {
    radius: f32,
    magnitudes: Distribution1D,
    negative: Vec<bool>,
    weight: f32,
}

/// An offset along one axis, drawn from a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSample {
    /// The offset from the filter's centre, in the units of the radius.
    pub offset: f32,
    /// The filter over the density, normalised so that its expectation is one.
    pub weight: f32,
}

impl TabulatedFilter {
    /// The table of `filter` on [−`radius`, `radius`]; the scale of its values does not matter.
    ///
    /// # Errors
    /// [`WeightError::Invalid`] where the filter or the radius is not finite (index of the cell),
    /// [`WeightError::ZeroSum`] where its integral is not positive.
    pub fn new(radius: f32, filter: impl Fn(f32) -> f32) -> Result<Self, WeightError> {
        if !(radius.is_finite() && radius > 0.0) {
            return Err(WeightError::Invalid { index: 0 });
        }
        let cell_width = 2.0 * radius / CELL_COUNT as f32;
        let values: Vec<f32> = (0..CELL_COUNT)
            .map(|cell| {
                // The mean over the cell by Simpson's rule.
                let at = |place: f32| filter((cell as f32 + place) * cell_width - radius);
                (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0
            })
            .collect();
        let magnitudes = Distribution1D::new(&values.iter().map(|v| v.abs()).collect::<Vec<_>>())?;
        let negative: Vec<bool> = values.iter().map(|&value| value < 0.0).collect();
        // From the table's own probabilities, so that the expectation is exactly one.
        let signed: f64 = (0..CELL_COUNT)
            .map(|cell| f64::from(magnitudes.pmf(cell)) * if negative[cell] { -1.0 } else { 1.0 })
            .sum();
        if signed <= 0.0 {
            return Err(WeightError::ZeroSum);
        }
        Ok(Self { radius, magnitudes, negative, weight: (1.0 / signed) as f32 })
    }

    /// The radius beyond which the filter is zero.
    #[inline]
    #[must_use]
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// An offset and its weight, from one uniform number. The map is monotonic, so it preserves strata.
    #[inline]
    #[must_use]
    pub fn sample(&self, uniform: f32) -> FilterSample {
        let (cell, rest) = self.magnitudes.sample_reuse(uniform);
        let position = (cell as f32 + rest) * (1.0 / CELL_COUNT as f32);
        let weight = if self.negative[cell] { -self.weight } else { self.weight };
        FilterSample { offset: (2.0 * position - 1.0) * self.radius, weight }
    }

    /// Offsets along both axes, and the product of the two weights: the filter of the plane that is
    /// the product of this one along each axis.
    #[inline]
    #[must_use]
    pub fn sample_2d(&self, uniform: Vec2) -> (Vec2, f32) {
        let (x, y) = (self.sample(uniform.x), self.sample(uniform.y));
        (Vec2::new(x.offset, y.offset), x.weight * y.weight)
    }

    /// The density per length of the offsets of [`sample`](Self::sample).
    #[inline]
    #[must_use]
    pub fn pdf(&self, offset: f32) -> f32 {
        let position = 0.5 * (offset / self.radius) + 0.5;
        0.5 * self.magnitudes.pdf(position) / self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::quadrature::adaptive_simpson;
    use etendue_testkit::{ChiSquare, TestRng};

    /// Mitchell and Netravali's filter with B = C = 1/3 on [−2, 2].
    fn mitchell(x: f32) -> f32 {
        let x = x.abs();
        let value = if x < 1.0 {
            7.0 * x * x * x - 12.0 * x * x + 16.0 / 3.0
        } else if x < 2.0 {
            -7.0 / 3.0 * x * x * x + 12.0 * x * x - 20.0 * x + 32.0 / 3.0
        } else {
            0.0
        };
        value / 6.0
    }

    /// A radius and a filter.
    type Case = (f32, fn(f32) -> f32);

    fn filters() -> [Case; 4] {
        [
            (2.0, mitchell),
            (0.5, |_| 1.0),
            (1.0, |x| 1.0 - x.abs()),
            (3.0, |x| {
                let sinc = |t: f32| if t == 0.0 { 1.0 } else { t.sin() / t };
                let t = std::f32::consts::PI * x;
                sinc(t) * sinc(t / 3.0)
            }),
        ]
    }

    #[test]
    fn offsets_follow_the_density() {
        for (radius, filter) in filters() {
            let table = TabulatedFilter::new(radius, filter).unwrap();
            let draw = |random: &mut TestRng| Some(table.sample(random.next_f32()).offset);
            let test = ChiSquare { resolution: (64, 4), ..ChiSquare::one_of(4) };
            test.line((-radius, radius), draw, |x| table.pdf(x)).assert();
        }
    }

    #[test]
    fn weights_reproduce_the_filter() {
        // The stratified mean of weight · g is ∫ f g / ∫ f, for g = 1, x, x², cos x.
        let probes: [fn(f64) -> f64; 4] = [|_| 1.0, |x| x, |x| x * x, f64::cos];
        for (radius, filter) in filters() {
            let table = TabulatedFilter::new(radius, filter).unwrap();
            let end = f64::from(radius);
            let integral = |g: &dyn Fn(f64) -> f64| {
                adaptive_simpson(|x| f64::from(filter(x as f32)) * g(x), -end, end, 1e-7)
            };
            let total = integral(&|_| 1.0);
            const COUNT: u32 = 1 << 18;
            for probe in probes {
                let mean = (0..COUNT)
                    .map(|index| table.sample((index as f32 + 0.5) / COUNT as f32))
                    .map(|sample| f64::from(sample.weight) * probe(f64::from(sample.offset)))
                    .sum::<f64>()
                    / f64::from(COUNT);
                let expected = integral(&probe) / total;
                assert!((mean - expected).abs() < 1e-4, "radius {radius}: {mean} {expected}");
            }
        }
    }

    #[test]
    fn the_plane_takes_the_product() {
        let table = TabulatedFilter::new(2.0, mitchell).unwrap();
        let (offset, weight) = table.sample_2d(Vec2::new(0.002, 0.4));
        let (x, y) = (table.sample(0.002), table.sample(0.4));
        assert!(x.weight < 0.0 && y.weight > 0.0);
        assert_eq!((offset, weight), (Vec2::new(x.offset, y.offset), x.weight * y.weight));
    }

    #[test]
    fn bad_filters_are_refused() {
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(TabulatedFilter::new(radius, |_| 1.0).is_err());
        }
        assert_eq!(TabulatedFilter::new(1.0, |_| 0.0), Err(WeightError::ZeroSum));
        assert_eq!(TabulatedFilter::new(1.0, |_| -1.0), Err(WeightError::ZeroSum));
        assert!(TabulatedFilter::new(1.0, |x| 1.0 / x).is_err());
    }
}
