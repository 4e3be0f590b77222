//! A piecewise constant density over the cells of a grid.

use super::cdf::{cell_of, fill_cdf, find_cell, position_in_cell};
use super::weights::{WeightError, check_grid};
use crate::hash::ONE_MINUS_EPSILON;
use glam::Vec2;

/// A piecewise constant density over [0, 1)², from a grid of weights: rows after the marginal, then
/// columns within the row. Four bytes per cell.
///
/// The density is exactly that of the single-precision tables that are sampled. A cell below about 10⁻⁷
/// of its row may have zero density.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution2D {
    width: usize,
    height: usize,
    /// Row after row, each of `width` + 1 edges.
    conditional: Vec<f32>,
    marginal: Vec<f32>,
    sum: f64,
}

impl Distribution2D {
    /// A table of `weights`, row after row from y = 0, of `size` (width, height).
    ///
    /// # Errors
    /// [`WeightError`], also where all weights are zero.
    pub fn new(weights: &[f32], size: (u32, u32)) -> Result<Self, WeightError> {
        check_grid(weights, size)?;
        let (width, height) = (size.0 as usize, size.1 as usize);
        let mut conditional = vec![0.0; (width + 1) * height];
        let rows = weights.chunks_exact(width).zip(conditional.chunks_exact_mut(width + 1));
        let row_sums: Vec<f64> = rows.map(|(row, cdf)| fill_cdf(row, cdf)).collect();
        let sum: f64 = row_sums.iter().sum();
        if sum <= 0.0 {
            return Err(WeightError::ZeroSum);
        }
        let shares: Vec<f32> = row_sums.iter().map(|row| (row / sum) as f32).collect();
        let mut marginal = vec![0.0; height + 1];
        fill_cdf(&shares, &mut marginal);
        Ok(Self { width, height, conditional, marginal, sum })
    }

    /// Width and height of the grid.
    #[inline]
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The integral over [0, 1]² of the step function whose values are the weights.
    #[inline]
    #[must_use]
    pub fn integral(&self) -> f64 {
        self.sum / (self.width as f64 * self.height as f64)
    }

    /// A point of [0, 1)² and its density.
    #[inline]
    #[must_use]
    pub fn sample(&self, uniform: Vec2) -> (Vec2, f32) {
        let (row, y) = split(&self.marginal, uniform.y);
        let cdf = self.row(row);
        let (column, x) = split(cdf, uniform.x);
        let point = Vec2::new(
            position_in_cell(column, x, self.width),
            position_in_cell(row, y, self.height),
        );
        (point, self.cell_pdf(column, row))
    }

    /// The density at a point; zero outside [0, 1)².
    #[inline]
    #[must_use]
    pub fn pdf(&self, point: Vec2) -> f32 {
        match (cell_of(point.x, self.width), cell_of(point.y, self.height)) {
            (Some(column), Some(row)) => self.cell_pdf(column, row),
            _ => 0.0,
        }
    }

    /// The uniform numbers that [`Self::sample`] maps to a point, which is clamped to [0, 1)².
    #[inline]
    #[must_use]
    pub fn invert(&self, point: Vec2) -> Vec2 {
        let point = point.clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON));
        let row = cell_of(point.y, self.height).unwrap_or(0);
        Vec2::new(join(self.row(row), point.x), join(&self.marginal, point.y))
    }

    #[inline]
    fn cell_pdf(&self, column: usize, row: usize) -> f32 {
        let cdf = self.row(row);
        let conditional = (cdf[column + 1] - cdf[column]) * self.width as f32;
        let marginal = (self.marginal[row + 1] - self.marginal[row]) * self.height as f32;
        conditional * marginal
    }

    #[inline]
    fn row(&self, row: usize) -> &[f32] {
        let stride = self.width + 1;
        &self.conditional[row * stride..(row + 1) * stride]
    }
}

/// The cell that contains a uniform number, and the number's position within it.
#[inline]
fn split(cdf: &[f32], uniform: f32) -> (usize, f32) {
    let cell = find_cell(cdf, uniform);
    let share = (uniform - cdf[cell]) / (cdf[cell + 1] - cdf[cell]);
    (cell, share.clamp(0.0, ONE_MINUS_EPSILON))
}

/// The uniform number of a position in [0, 1): the inverse of [`split`].
#[inline]
fn join(cdf: &[f32], position: f32) -> f32 {
    let count = cdf.len() - 1;
    let cell = cell_of(position, count).unwrap_or(0);
    let share = position * count as f32 - cell as f32;
    (cdf[cell] + share * (cdf[cell + 1] - cdf[cell])).clamp(0.0, ONE_MINUS_EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::{ChiSquare, TestRng};

    /// A bright spot, dark cells and a dark row.
    fn weights(width: u32, height: u32) -> Vec<f32> {
        let mut random = TestRng::new(1);
        (0..width * height)
            .map(|index| match index / width {
                3 => 0.0,
                _ if index % 5 == 2 => 0.0,
                _ if index == 7 * width + 1 => 200.0,
                _ => random.next_f32(),
            })
            .collect()
    }

    #[test]
    fn samples_follow_the_density() {
        for size in [(16, 8), (13, 11), (1, 9), (9, 1)] {
            let table = Distribution2D::new(&weights(size.0, size.1), size).unwrap();
            ChiSquare::one_of(4)
                .square(
                    |random| {
                        let (point, pdf) = table.sample(random.next_vec2());
                        assert_eq!(pdf, table.pdf(point));
                        Some(point)
                    },
                    |point| table.pdf(point),
                )
                .assert();
        }
    }

    #[test]
    fn the_density_is_that_of_the_weights() {
        let weights = weights(16, 8);
        let table = Distribution2D::new(&weights, (16, 8)).unwrap();
        for (index, weight) in weights.iter().enumerate() {
            let centre = Vec2::new((index % 16) as f32 + 0.5, (index / 16) as f32 + 0.5);
            let pdf = table.pdf(centre / Vec2::new(16.0, 8.0));
            let expected = f64::from(*weight) / table.integral();
            assert!((f64::from(pdf) - expected).abs() < 1e-4, "{index}: {pdf} {expected}");
        }
        assert_eq!(table.pdf(Vec2::new(1.0, 0.5)), 0.0);
        assert_eq!(table.pdf(Vec2::new(0.5, f32::NAN)), 0.0);
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        let table = Distribution2D::new(&weights(16, 8), (16, 8)).unwrap();
        let mut random = TestRng::new(2);
        for _ in 0..20_000 {
            let uniform = random.next_vec2();
            assert!(table.invert(table.sample(uniform).0).distance(uniform) < 1e-5);
        }
    }

    #[test]
    fn bad_grids_are_refused() {
        let shape = Err(WeightError::Shape { expected: 6, found: 5 });
        assert_eq!(Distribution2D::new(&[1.0; 5], (2, 3)), shape);
        assert_eq!(Distribution2D::new(&[], (0, 3)), Err(WeightError::Empty));
        assert_eq!(Distribution2D::new(&[0.0; 6], (2, 3)), Err(WeightError::ZeroSum));
        let invalid = Err(WeightError::Invalid { index: 0 });
        assert_eq!(Distribution2D::new(&[f32::NAN], (1, 1)), invalid);
    }
}
