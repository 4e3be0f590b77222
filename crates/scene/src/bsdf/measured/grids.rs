//! Tables over the unit square, and sampling of points from them. They are bilinear between
//! entries, and linear in further parameters that interpolate among many such tables.
//!
//! Dupuy and Jakob, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering",
//! 2018, section 4.

use glam::Vec2;

/// A few tables of a stack with their weights, which sum to one.
pub(super) type Mix = [(usize, f32); 4];

/// The only table of a stack.
pub(super) const ONLY: Mix = [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];

/// A stack of tables of equal size.
#[derive(Clone, Debug)]
pub(super) struct Grids {
    columns: usize,
    rows: usize,
    /// Table by table, row by row.
    values: Vec<f32>,
}

/// Tables as densities of points. Each integrates to one over the unit square.
#[derive(Clone, Debug)]
pub(super) struct Densities {
    grids: Grids,
    /// For each entry, the running sum along its row, by the trapezoidal rule with unit width.
    along: Vec<f32>,
    /// For each row, the running sum over the rows.
    across: Vec<f32>,
}

/// A cell of a table, and the position in it, from 0 to 1 in both directions.
struct Cell {
    column: usize,
    row: usize,
    within: Vec2,
}

impl Grids {
    /// Tables with at least two entries in both directions; `None` if the count of numbers does not
    /// match.
    pub(super) fn new(columns: usize, rows: usize, values: Vec<f32>) -> Option<Self> {
        let whole = columns >= 2 && rows >= 2 && !values.is_empty();
        let filled = whole && values.len().is_multiple_of(columns.checked_mul(rows)?);
        filled.then_some(Self { columns, rows, values })
    }

    fn cell(&self, place: Vec2) -> Cell {
        let scaled = place * Vec2::new((self.columns - 1) as f32, (self.rows - 1) as f32);
        // Casts saturate and map NaN to zero.
        let column = (scaled.x as usize).min(self.columns - 2);
        let row = (scaled.y as usize).min(self.rows - 2);
        let within = scaled - Vec2::new(column as f32, row as f32);
        Cell { column, row, within: within.clamp(Vec2::ZERO, Vec2::ONE) }
    }

    #[inline]
    fn mixed(&self, mix: &Mix, row: usize, column: usize) -> f32 {
        let size = self.columns * self.rows;
        mixture(mix, |table| self.values[table * size + row * self.columns + column])
    }

    /// The values at both ends of a cell, at a given height in it.
    #[inline]
    fn ends(&self, mix: &Mix, row: usize, column: usize, height: f32) -> [f32; 2] {
        [column, column + 1].map(|column| {
            let (low, high) = (self.mixed(mix, row, column), self.mixed(mix, row + 1, column));
            low + height * (high - low)
        })
    }

    /// The value at a point of the unit square.
    pub(super) fn eval(&self, mix: &Mix, place: Vec2) -> f32 {
        let Cell { column, row, within } = self.cell(place);
        let [low, high] = self.ends(mix, row, column, within.y);
        low + within.x * (high - low)
    }
}

/// A weighted sum of a quantity over some tables.
#[inline]
fn mixture(mix: &Mix, of: impl Fn(usize) -> f32) -> f32 {
    mix.iter().filter(|(_, share)| *share != 0.0).map(|&(table, share)| share * of(table)).sum()
}

impl Densities {
    /// Normalises every table; `None` if a table sums to zero.
    pub(super) fn new(mut grids: Grids) -> Option<Self> {
        let Grids { columns, rows, .. } = grids;
        let mut along = Vec::with_capacity(grids.values.len());
        let mut across = Vec::with_capacity(grids.values.len() / columns);
        for table in grids.values.chunks_exact_mut(columns * rows) {
            let (total, sums, row_sums) = sums(table, columns);
            if !(total > 0.0 && total.is_finite()) {
                return None;
            }
            along.extend(sums.iter().map(|sum| (sum / total) as f32));
            across.extend(row_sums.iter().map(|sum| (sum / total) as f32));
            table.iter_mut().for_each(|value| *value = (f64::from(*value) / total) as f32);
        }
        Some(Self { grids, along, across })
    }

    /// The density at a point, normalised to unit cells.
    #[inline]
    fn per_square(&self, per_cell: f32) -> f32 {
        per_cell * ((self.grids.columns - 1) * (self.grids.rows - 1)) as f32
    }

    /// The density at a point of the unit square.
    pub(super) fn pdf(&self, mix: &Mix, place: Vec2) -> f32 {
        self.per_square(self.grids.eval(mix, place))
    }

    /// The sum along the row up to an entry.
    #[inline]
    fn sum_along(&self, mix: &Mix, row: usize, column: usize) -> f32 {
        let Grids { columns, rows, .. } = self.grids;
        mixture(mix, |table| self.along[(table * rows + row) * columns + column])
    }

    #[inline]
    fn sum_across(&self, mix: &Mix, row: usize) -> f32 {
        mixture(mix, |table| self.across[table * self.grids.rows + row])
    }

    /// The sums along the full rows below and above a cell.
    #[inline]
    fn row_totals(&self, mix: &Mix, row: usize) -> [f32; 2] {
        [row, row + 1].map(|row| self.sum_along(mix, row, self.grids.columns - 1))
    }

    /// Samples a point with that density, and returns the density.
    pub(super) fn sample(&self, mix: &Mix, uniform: Vec2) -> (Vec2, f32) {
        let Grids { columns, rows, .. } = self.grids;
        let row = last_below(rows - 1, uniform.y, |row| self.sum_across(mix, row));
        let totals = self.row_totals(mix, row);
        let y = invert_trapezoid(totals, uniform.y - self.sum_across(mix, row));
        let between = |column| {
            let [low, high] = [row, row + 1].map(|row| self.sum_along(mix, row, column));
            low + y * (high - low)
        };
        let wanted = uniform.x * (totals[0] + y * (totals[1] - totals[0]));
        let column = last_below(columns - 1, wanted, between);
        let ends = self.grids.ends(mix, row, column, y);
        let x = invert_trapezoid(ends, wanted - between(column));
        let size = Vec2::new((columns - 1) as f32, (rows - 1) as f32);
        let place = Vec2::new(column as f32 + x, row as f32 + y) / size;
        (place, self.per_square(ends[0] + x * (ends[1] - ends[0])))
    }

    /// The inverse of sampling: the uniform numbers that give a point, and the density there.
    pub(super) fn invert(&self, mix: &Mix, place: Vec2) -> (Vec2, f32) {
        let Cell { column, row, within: Vec2 { x, y } } = self.grids.cell(place);
        let ends = self.grids.ends(mix, row, column, y);
        let totals = self.row_totals(mix, row);
        let [low, high] = [row, row + 1].map(|row| self.sum_along(mix, row, column));
        let along = trapezoid(ends, x) + low + y * (high - low);
        let total = totals[0] + y * (totals[1] - totals[0]);
        let along = if total > 0.0 { along / total } else { 0.0 };
        let across = trapezoid(totals, y) + self.sum_across(mix, row);
        let uniform = Vec2::new(along, across).clamp(Vec2::ZERO, Vec2::ONE);
        (uniform, self.per_square(ends[0] + x * (ends[1] - ends[0])))
    }
}

/// The total of a table, and its sums along and across rows.
fn sums(table: &[f32], columns: usize) -> (f64, Vec<f64>, Vec<f64>) {
    let mut along = Vec::with_capacity(table.len());
    let mut across = Vec::new();
    let (mut total, mut last_row) = (0.0, None);
    for row in table.chunks_exact(columns) {
        let mut sum = 0.0;
        along.push(sum);
        for pair in row.windows(2) {
            sum += 0.5 * (f64::from(pair[0]) + f64::from(pair[1]));
            along.push(sum);
        }
        if let Some(last) = last_row.replace(sum) {
            total += 0.5 * (last + sum);
        }
        across.push(total);
    }
    (total, along, across)
}

/// The last of the cells 0 to `count` − 1 whose preceding sum does not exceed `wanted`.
fn last_below(count: usize, wanted: f32, sum_before: impl Fn(usize) -> f32) -> usize {
    let (mut low, mut high) = (0, count);
    while high - low > 1 {
        let middle = low.midpoint(high);
        if sum_before(middle) <= wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The area from 0 to `x` in [0, 1] under the line from `ends[0]` to `ends[1]`.
#[inline]
fn trapezoid(ends: [f32; 2], x: f32) -> f32 {
    x * (ends[0] + 0.5 * x * (ends[1] - ends[0]))
}

/// The inverse of that area.
#[inline]
fn invert_trapezoid(ends: [f32; 2], area: f32) -> f32 {
    let root = (ends[0] * ends[0] + 2.0 * area * (ends[1] - ends[0])).max(0.0).sqrt();
    let divisor = ends[0] + root;
    if divisor > 0.0 { (2.0 * area / divisor).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::TestRng;

    fn stack() -> Densities {
        let mut random = TestRng::new(4);
        let values = (0..3 * 5 * 4).map(|_| random.range_f32(0.1, 2.0)).collect();
        Densities::new(Grids::new(5, 4, values).expect("whole tables")).expect("positive tables")
    }

    const MIX: Mix = [(0, 0.2), (2, 0.5), (1, 0.3), (0, 0.0)];

    #[test]
    fn the_inverse_undoes_the_sampling() {
        let stack = stack();
        let mut random = TestRng::new(5);
        for _ in 0..2000 {
            let uniform = random.next_vec2();
            let (place, pdf) = stack.sample(&MIX, uniform);
            let (back, same) = stack.invert(&MIX, place);
            assert!((back - uniform).abs().max_element() < 1e-5, "{uniform} {place} {back}");
            assert!((pdf - same).abs() < 1e-4 && (pdf - stack.pdf(&MIX, place)).abs() < 1e-4);
        }
    }

    #[test]
    fn densities_integrate_to_one() {
        let stack = stack();
        let count = 600;
        let at = |i: i32| (f64::from(i) + 0.5) / f64::from(count);
        let pdf = |x: i32, y: i32| stack.pdf(&MIX, Vec2::new(at(x) as f32, at(y) as f32));
        let sum: f64 = (0..count)
            .flat_map(|y| (0..count).map(move |x| (x, y)))
            .map(|(x, y)| f64::from(pdf(x, y)))
            .sum();
        assert!((sum / f64::from(count * count) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn tables_without_content_are_refused() {
        assert!(Densities::new(Grids::new(2, 2, vec![0.0; 4]).expect("a table")).is_none());
        assert!(Grids::new(1, 4, vec![1.0; 4]).is_none());
        assert!(Grids::new(3, 2, vec![1.0; 5]).is_none());
        assert!(Grids::new(usize::MAX, 3, vec![1.0; 5]).is_none());
    }
}
