//! Spatial splits: before the build, large slanted triangles are cut into several references, each
//! with a box around a part.
//!
//! Karras and Aila, *Fast Parallel Construction of High-Quality Bounding Volume Hierarchies* (HPG
//! 2013), section 4.3: the emptiest boxes are split most. The cuts are at planes of a grid over the
//! scene, so that neighbouring triangles are cut at the same places.

use super::reference::Reference;
use crate::geometry::GeometryView;
use etendue_math::Bounds3;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// The grid has 2^`GRID_BITS` cells per axis.
const GRID_BITS: i32 = 16;

/// The references after splitting the worthwhile ones. At most `budget` times their number are
/// added. Empty if there is nothing to split.
pub(super) fn presplit(
    references: &[Reference],
    geometries: &[GeometryView<'_>],
    budget: f32,
) -> Vec<Reference> {
    if !(budget > 0.0 && budget.is_finite()) || references.is_empty() {
        return Vec::new();
    }
    let budget = budget.min(MAX_BUDGET);
    let corners = |reference: &Reference| triangle_of(reference, geometries);
    let priorities: Vec<f64> =
        references.par_iter().map(|r| if r.is_custom() { 0.0 } else { emptiness(r) }).collect();
    // Sequential, so that the sum does not depend on the number of threads.
    let total: f64 = priorities.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return Vec::new();
    }
    let per_priority = f64::from(budget) * references.len() as f64 / total;
    let scene = references.iter().fold(Bounds3::EMPTY, |all, r| all.union(r.bounds()));
    let grid = Grid::new(&scene);
    // The integer steps of a running sum, so that many small priorities get their share of splits.
    let mut claimed = 0.0_f64;
    let splits: Vec<usize> = priorities
        .iter()
        .map(|priority| {
            let before = claimed.floor();
            claimed += priority * per_priority;
            ((claimed.floor() - before) as usize).min(MAX_SPLITS)
        })
        .collect();
    let split: Vec<Vec<Reference>> = references
        .par_iter()
        .zip(&splits)
        .map(|(reference, &splits)| {
            let mut parts = Vec::with_capacity(splits + 1);
            match corners(reference) {
                Some(triangle) => cut(*reference, &triangle, (&grid, splits), &mut parts),
                None => parts.push(*reference),
            }
            parts
        })
        .collect();
    split.into_iter().flatten().collect()
}

/// The maximum number of splits per reference on average, to bound memory.
const MAX_BUDGET: f32 = 8.0;

/// The maximum number of cuts of one triangle; this also bounds the recursion.
const MAX_SPLITS: usize = 256;

fn triangle_of(reference: &Reference, geometries: &[GeometryView<'_>]) -> Option<[DVec3; 3]> {
    let GeometryView::Triangles(mesh) = geometries.get(reference.geometry() as usize)? else {
        return None;
    };
    let corners = mesh.indices.get(reference.primitive() as usize)?;
    Some(corners.map(|index| mesh.positions[index as usize].as_dvec3()))
}

/// The side of a cube with the volume of the box: the space that a slanted triangle wastes.
///
/// The paper uses the surface area that ideal boxes would save. For a flat box around a triangle
/// that is half its area, so walls and floors were cut, and rays were a third slower: a wall in one
/// leaf near the root is tested once, but its pieces spread through the tree and enlarge many
/// nodes.
fn emptiness(reference: &Reference) -> f64 {
    let extent = reference.bounds().extent().as_dvec3();
    (extent.x * extent.y * extent.z).cbrt()
}

/// The planes where triangles are cut.
struct Grid {
    origin: Vec3,
    cell: Vec3,
}

impl Grid {
    fn new(scene: &Bounds3) -> Self {
        let cells = (1_u32 << GRID_BITS) as f32;
        Self { origin: scene.min, cell: scene.extent() / cells }
    }

    /// The coarsest grid plane inside the interval, or else the middle of the interval.
    fn plane(&self, axis: usize, least: f32, greatest: f32) -> f32 {
        let (origin, cell) = (self.origin[axis], self.cell[axis]);
        let number = |place: f32| ((place - origin) / cell) as u32;
        let (first, last) = (number(least), number(greatest));
        let middle = least * 0.5 + greatest * 0.5;
        let Some(bit) = (first ^ last).checked_ilog2() else { return middle };
        let plane = origin + (last >> bit << bit) as f32 * cell;
        if plane > least && plane < greatest { plane } else { middle }
    }
}

/// Cuts a reference, and distributes the remaining splits by the areas of the parts. Every level
/// consumes a split, so the recursion is at most [`MAX_SPLITS`] deep.
fn cut(
    reference: Reference,
    triangle: &[DVec3; 3],
    (grid, splits): (&Grid, usize),
    parts: &mut Vec<Reference>,
) {
    let bounds = reference.bounds();
    let extent = bounds.extent();
    let axis = if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    let plane = grid.plane(axis, bounds.min[axis], bounds.max[axis]);
    let [left, right] = halves(triangle, axis, plane).map(|half| half.intersection(bounds));
    if splits == 0 || left.is_empty() || right.is_empty() {
        parts.push(reference);
        return;
    }
    let (left_size, right_size) = (left.half_area(), right.half_area());
    let whole = (left_size + right_size).max(f32::MIN_POSITIVE);
    let to_left = ((splits - 1) as f32 * left_size / whole).round() as usize;
    let to_left = to_left.min(splits - 1);
    cut(reference.with_bounds(left), triangle, (grid, to_left), parts);
    cut(reference.with_bounds(right), triangle, (grid, splits - 1 - to_left), parts);
}

/// The boxes around the parts of a triangle on the two sides of a plane. The point where an edge
/// crosses the plane is off by one rounding, which the padding of boxes allows for.
fn halves(triangle: &[DVec3; 3], axis: usize, plane: f32) -> [Bounds3; 2] {
    let mut boxes = [Bounds3::EMPTY; 2];
    let at = f64::from(plane);
    for index in 0..3 {
        let (from, to) = (triangle[index], triangle[(index + 1) % 3]);
        if from[axis] <= at {
            boxes[0] = boxes[0].with_point(from.as_vec3());
        }
        if from[axis] >= at {
            boxes[1] = boxes[1].with_point(from.as_vec3());
        }
        if (from[axis] < at) != (to[axis] < at) && from[axis] != to[axis] {
            let mut crossing = from.lerp(to, (at - from[axis]) / (to[axis] - from[axis])).as_vec3();
            crossing[axis] = plane;
            boxes = boxes.map(|bounds| bounds.with_point(crossing));
        }
    }
    boxes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_cover_the_triangle_and_meet_at_the_plane() {
        let triangle = [DVec3::ZERO, DVec3::new(4.0, 1.0, 0.0), DVec3::new(4.0, 4.0, 2.0)];
        let [left, right] = halves(&triangle, 0, 1.0);
        assert_eq!(left, Bounds3::new(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.5)));
        assert_eq!(right, Bounds3::new(Vec3::new(1.0, 0.25, 0.0), Vec3::new(4.0, 4.0, 2.0)));
    }
}
