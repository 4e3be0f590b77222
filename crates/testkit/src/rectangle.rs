//! Rectangles of the plane.

use glam::DVec2;

/// An axis-aligned rectangle of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// The minimum corner.
    pub min: DVec2,
    /// The maximum corner.
    pub max: DVec2,
}

impl Rectangle {
    /// The unit square.
    pub(crate) const UNIT: Self = Self { min: DVec2::ZERO, max: DVec2::ONE };

    /// Cell (`column`, `row`) of this rectangle divided into `columns` × `rows`.
    pub(crate) fn cell(
        &self,
        (column, row): (usize, usize),
        (columns, rows): (usize, usize),
    ) -> Self {
        let size = self.max - self.min;
        let corner = |column: usize, row: usize| {
            let fraction = DVec2::new(column as f64 / columns as f64, row as f64 / rows as f64);
            self.min + size * fraction
        };
        Self { min: corner(column, row), max: corner(column + 1, row + 1) }
    }

    /// The two halves along axis 0 (x) or 1 (y).
    pub(crate) fn halves(&self, axis: usize) -> [Self; 2] {
        let mut halves = [*self; 2];
        let middle = 0.5 * (self.min[axis] + self.max[axis]);
        halves[0].max[axis] = middle;
        halves[1].min[axis] = middle;
        halves
    }

    /// Whether `point` is inside or on the lower edges.
    pub(crate) fn contains(&self, point: DVec2) -> bool {
        point.cmpge(self.min).all() && point.cmplt(self.max).all()
    }
}

/// The axis (0 or 1) along which the two halves contain more unequal numbers of points.
pub(crate) fn crowded_axis(halves: &[[Rectangle; 2]; 2], points: &[DVec2]) -> usize {
    let imbalance = |axis: usize| {
        let position = halves[axis][1].min[axis];
        let low = points.iter().filter(|point| point[axis] < position).count();
        low.abs_diff(points.len() - low)
    };
    usize::from(imbalance(1) > imbalance(0))
}
