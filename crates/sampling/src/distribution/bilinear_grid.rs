//! A density over the unit square that interpolates a grid bilinearly, as a texture lookup does.

use super::cdf::find_cell;
use super::weights::{WeightError, check_grid};
use crate::hash::ONE_MINUS_EPSILON;
use crate::warp::linear;
use glam::Vec2;

/// The bilinear interpolant of a grid of weights as a density over [0, 1)², for environment maps.
///
/// Weight (i, j) sits at the centre of its cell, ((i + ½)/width, (j + ½)/height). The interpolant
/// wraps round in x and is constant beyond the outermost centres in y: a map by longitude and
/// latitude. The density is positive wherever the interpolant is. Eight bytes per weight.
#[derive(Clone, Debug, PartialEq)]
pub struct BilinearDistribution2D {
    width: usize,
    height: usize,
    /// The weights, scaled so that their interpolant is the density.
    density: Vec<f32>,
    /// Per row, the integral of the density from the first centre to each centre, in cells; the last
    /// entry is the whole way round.
    conditional: Vec<f32>,
    /// Per row, the density of the interpolant's y at the row's centre.
    row_density: Vec<f32>,
    /// The cumulative share of y: at 0, at every row's centre, and at 1.
    marginal: Vec<f32>,
    integral: f64,
}

/// A height in [0, 1] as a position between two rows.
struct Height {
    below: usize,
    above: usize,
    share: f32,
}

impl BilinearDistribution2D {
    /// The density of `weights`, row after row from y = 0, of `size` (width, height).
    ///
    /// # Errors
    /// [`WeightError`], also where all weights are zero.
    pub fn new(weights: &[f32], size: (u32, u32)) -> Result<Self, WeightError> {
        check_grid(weights, size)?;
        let (width, height) = (size.0 as usize, size.1 as usize);
        let sum: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
        if sum <= 0.0 {
            return Err(WeightError::ZeroSum);
        }
        let integral = sum / weights.len() as f64;
        let density: Vec<f32> =
            weights.iter().map(|&weight| (f64::from(weight) / integral) as f32).collect();
        let mut conditional = Vec::with_capacity((width + 1) * height);
        let mut row_density = Vec::with_capacity(height);
        for row in density.chunks_exact(width) {
            let mut running = 0.0_f64;
            conditional.push(0.0);
            for column in 0..width {
                running += 0.5 * (f64::from(row[column]) + f64::from(row[(column + 1) % width]));
                conditional.push(running as f32);
            }
            row_density.push((running / width as f64) as f32);
        }
        let marginal = marginal_cdf(&row_density);
        Ok(Self { width, height, density, conditional, row_density, marginal, integral })
    }

    /// Width and height of the grid.
    #[inline]
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The integral of the weights' interpolant over [0, 1]².
    #[inline]
    #[must_use]
    pub fn integral(&self) -> f64 {
        self.integral
    }

    /// A point of [0, 1)² and its density.
    #[inline]
    #[must_use]
    pub fn sample(&self, uniform: Vec2) -> (Vec2, f32) {
        let segment = find_cell(&self.marginal, uniform.y);
        let (start, end) = (self.marginal[segment], self.marginal[segment + 1]);
        let rest = ((uniform.y - start) / (end - start)).clamp(0.0, ONE_MINUS_EPSILON);
        let (below, above) = (segment.saturating_sub(1), segment.min(self.height - 1));
        let share = linear::sample(rest, self.row_density[below], self.row_density[above]);
        let height = Height { below, above, share };
        let column = self.find_column(&height, uniform.x);
        let (low, high) = self.column_integrals(&height, column);
        let target = uniform.x * self.row_integral(&height, self.width);
        let rest = ((target - low) / (high - low)).clamp(0.0, ONE_MINUS_EPSILON);
        let (left, right) = self.ends(&height, column);
        let x_share = linear::sample(rest, left, right);
        let x = (column as f32 + 0.5 + x_share) / self.width as f32;
        let x = if x >= 1.0 { x - 1.0 } else { x };
        let y = self.height_of(segment, share);
        let point = Vec2::new(x, y).clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON));
        (point, left + x_share * (right - left))
    }

    /// The density at a point: the interpolant over its integral; zero outside [0, 1)².
    #[inline]
    #[must_use]
    pub fn pdf(&self, point: Vec2) -> f32 {
        if !(point.cmpge(Vec2::ZERO).all() && point.cmplt(Vec2::ONE).all()) {
            return 0.0;
        }
        let (column, x_share) = self.locate_column(point.x);
        let (_, height) = self.locate_row(point.y);
        let (left, right) = self.ends(&height, column);
        left + x_share * (right - left)
    }

    /// The uniform numbers that [`Self::sample`] maps to a point, which is clamped to [0, 1)².
    #[inline]
    #[must_use]
    pub fn invert(&self, point: Vec2) -> Vec2 {
        let point = point.clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON));
        let (segment, height) = self.locate_row(point.y);
        let (start, end) = (self.marginal[segment], self.marginal[segment + 1]);
        let (below, above) = (self.row_density[height.below], self.row_density[height.above]);
        let y = start + linear::invert(height.share, below, above) * (end - start);
        let (column, x_share) = self.locate_column(point.x);
        let (left, right) = self.ends(&height, column);
        let (low, high) = self.column_integrals(&height, column);
        let x = low + linear::invert(x_share, left, right) * (high - low);
        let whole = self.row_integral(&height, self.width);
        let x = if whole > 0.0 { x / whole } else { point.x };
        Vec2::new(x, y).clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
    }

    /// The density's integral along the line at this height, from the first centre to `edge`.
    #[inline]
    fn row_integral(&self, height: &Height, edge: usize) -> f32 {
        let stride = self.width + 1;
        let below = self.conditional[height.below * stride + edge];
        let above = self.conditional[height.above * stride + edge];
        // Unlike below + share · (above − below), this form preserves the order of the edges.
        (1.0 - height.share) * below + height.share * above
    }

    #[inline]
    fn column_integrals(&self, height: &Height, column: usize) -> (f32, f32) {
        (self.row_integral(height, column), self.row_integral(height, column + 1))
    }

    /// The piece between two centres that contains the share `uniform` of the line.
    #[inline]
    fn find_column(&self, height: &Height, uniform: f32) -> usize {
        let target = uniform * self.row_integral(height, self.width);
        let (mut low, mut high) = (0, self.width - 1);
        while low < high {
            let middle = (low + high) / 2;
            if self.row_integral(height, middle + 1) > target {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        low
    }

    /// The density at the two centres around a piece of the line at this height.
    #[inline]
    fn ends(&self, height: &Height, column: usize) -> (f32, f32) {
        let next = if column + 1 == self.width { 0 } else { column + 1 };
        let at = |column: usize| {
            let below = self.density[height.below * self.width + column];
            let above = self.density[height.above * self.width + column];
            (1.0 - height.share) * below + height.share * above
        };
        (at(column), at(next))
    }

    /// The piece between two centres that contains `x` in [0, 1), and the position within it.
    #[inline]
    fn locate_column(&self, x: f32) -> (usize, f32) {
        let place = x * self.width as f32 - 0.5;
        let place = if place < 0.0 { place + self.width as f32 } else { place };
        let column = (place as usize).min(self.width - 1);
        (column, (place - column as f32).clamp(0.0, 1.0))
    }

    /// The segment of the marginal that contains `y` in [0, 1), and the position within it.
    #[inline]
    fn locate_row(&self, y: f32) -> (usize, Height) {
        let place = y * self.height as f32 + 0.5;
        let segment = (place as usize).min(self.height);
        let share = (place - segment as f32).clamp(0.0, 1.0);
        // The two outer segments are half as high.
        let share = match segment {
            0 => (2.0 * share - 1.0).max(0.0),
            _ if segment == self.height => (2.0 * share).min(1.0),
            _ => share,
        };
        let (below, above) = (segment.saturating_sub(1), segment.min(self.height - 1));
        (segment, Height { below, above, share })
    }

    /// The height at a share of a segment of the marginal; undoes [`locate_row`](Self::locate_row).
    #[inline]
    fn height_of(&self, segment: usize, share: f32) -> f32 {
        let place = match segment {
            0 => 0.5 * share,
            _ if segment == self.height => segment as f32 - 0.5 + 0.5 * share,
            _ => segment as f32 - 0.5 + share,
        };
        place / self.height as f32
    }
}

/// The cumulative shares of y at 0, at the rows' centres and at 1.
fn marginal_cdf(row_density: &[f32]) -> Vec<f32> {
    let at = |row: usize| f64::from(row_density[row]);
    let last = row_density.len() - 1;
    let pieces: Vec<f64> = (0..=last + 1)
        .map(|segment| match segment {
            0 => 0.5 * at(0),
            _ if segment > last => 0.5 * at(last),
            _ => 0.5 * (at(segment - 1) + at(segment)),
        })
        .collect();
    let sum: f64 = pieces.iter().sum();
    let end = pieces.iter().rposition(|&piece| piece > 0.0).unwrap_or(last);
    let mut running = 0.0;
    let mut cdf = vec![0.0];
    for (segment, piece) in pieces.iter().enumerate() {
        running += piece;
        // Rounding must not leave a gap before one.
        cdf.push(if segment >= end { 1.0 } else { (running / sum).min(1.0) as f32 });
    }
    cdf
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::{ChiSquare, TestRng};

    fn weights(width: u32, height: u32) -> Vec<f32> {
        let mut random = TestRng::new(1);
        (0..width * height)
            .map(|index| match index {
                _ if index % 5 == 2 => 0.0,
                5 => 60.0,
                _ => random.next_f32(),
            })
            .collect()
    }

    const SIZES: [(u32, u32); 5] = [(16, 8), (7, 5), (1, 6), (6, 1), (2, 2)];

    #[test]
    fn samples_follow_the_density() {
        for size in SIZES {
            let table = BilinearDistribution2D::new(&weights(size.0, size.1), size).unwrap();
            ChiSquare::one_of(5)
                .square(
                    |random| {
                        let (point, pdf) = table.sample(random.next_vec2());
                        let again = table.pdf(point);
                        assert!((pdf - again).abs() < 2e-4 * (1.0 + pdf), "{pdf} {again}");
                        Some(point)
                    },
                    |point| table.pdf(point),
                )
                .assert();
        }
    }

    #[test]
    fn the_density_is_the_interpolant() {
        let weights = weights(7, 5);
        let table = BilinearDistribution2D::new(&weights, (7, 5)).unwrap();
        let scale = table.integral() as f32;
        let at = |x: f32, y: f32| table.pdf(Vec2::new(x / 7.0, y / 5.0)) * scale;
        let weight = |column: usize, row: usize| weights[row * 7 + column];
        for (column, row) in [(0, 0), (3, 2), (6, 4)] {
            let centre = at(column as f32 + 0.5, row as f32 + 0.5);
            assert!((centre - weight(column, row)).abs() < 1e-4);
        }
        // Across the wrap, beyond the last row, and in the middle of four centres.
        assert!((at(0.0, 0.5) - 0.5 * (weight(0, 0) + weight(6, 0))).abs() < 1e-4);
        assert!((at(3.5, 4.9) - weight(3, 4)).abs() < 1e-4);
        let four = weight(1, 1) + weight(2, 1) + weight(1, 2) + weight(2, 2);
        assert!((at(2.0, 2.0) - 0.25 * four).abs() < 1e-4);
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        let table = BilinearDistribution2D::new(&weights(16, 8), (16, 8)).unwrap();
        let mut random = TestRng::new(2);
        for _ in 0..20_000 {
            let uniform = random.next_vec2();
            let back = table.invert(table.sample(uniform).0);
            assert!(back.distance(uniform) < 2e-4, "{uniform} {back}");
        }
    }

    #[test]
    fn one_bright_weight_spreads_to_its_neighbours_only() {
        let mut weights = vec![0.0; 64];
        weights[8 * 3 + 4] = 1.0;
        let table = BilinearDistribution2D::new(&weights, (8, 8)).unwrap();
        let mut random = TestRng::new(3);
        for _ in 0..20_000 {
            let (point, pdf) = table.sample(random.next_vec2());
            let distance = (point * 8.0 - Vec2::new(4.5, 3.5)).abs().max_element();
            assert!(distance <= 1.0 + 1e-5 && pdf >= 0.0);
        }
    }

    #[test]
    fn bad_grids_are_refused() {
        let shape = Err(WeightError::Shape { expected: 4, found: 3 });
        assert_eq!(BilinearDistribution2D::new(&[1.0; 3], (2, 2)), shape);
        assert_eq!(BilinearDistribution2D::new(&[0.0; 4], (2, 2)), Err(WeightError::ZeroSum));
        let invalid = Err(WeightError::Invalid { index: 2 });
        assert_eq!(BilinearDistribution2D::new(&[1.0, 0.0, -1.0, 2.0], (2, 2)), invalid);
    }
}
