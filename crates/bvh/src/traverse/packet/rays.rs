//! Per-packet constants of the box and triangle tests.
//!
//! All values have the same bits as those of [`RayConstants`](super::super::ray::RayConstants) and
//! [`BoxConstants`](super::super::ray::BoxConstants) for a single ray.

use crate::error_bounds::{MIN_DIRECTION, PADDING};
use crate::node::Node;
use crate::simd::wide::{MAX_LANES, Row, Wide};
use etendue_math::Ray;

/// The constants of the box test and of the triangle test.
pub(super) struct Packet<W: Wide> {
    /// The inverse directions, whose components are clamped away from zero.
    inverse: [W::Vector; 3],
    /// The offsets added to the distances of a box's lower planes.
    lower_offset: [W::Vector; 3],
    /// The offsets added to the distances of a box's upper planes.
    upper_offset: [W::Vector; 3],
    /// The two minor axes, then the axis of the direction's greatest component.
    pub(super) axes: [W::Axes; 3],
    /// The origins, in the order of `axes`.
    pub(super) origin: [W::Vector; 3],
    /// The slopes along the minor axes, then the inverse of the greatest component.
    pub(super) shear: [W::Vector; 3],
    /// The ends of the rays, inclusive; -1 in lanes that are not `regular`.
    pub(super) t_max: W::Vector,
    /// The lanes whose distances from everything in the tree are finite, with a margin. The others
    /// are traced singly, so the packet tests need not handle NaN.
    pub(super) regular: u32,
}

/// Distances up to this value leave room for the sums and products of the box test.
const MAX_DISTANCE: f32 = 1e36;

impl<W: Wide> Packet<W> {
    /// Prepares rays for a tree whose coordinates are at most `reach` by magnitude.
    #[inline(always)]
    pub(super) fn new(columns: &Columns, reach: f32) -> Self {
        let Columns([ox, oy, oz, dx, dy, dz, ends]) = columns;
        let origin = [W::load(ox), W::load(oy), W::load(oz)];
        let direction = [W::load(dx), W::load(dy), W::load(dz)];
        let magnitude = absolute::<W>(&direction);
        let greatest = max_of::<W>(&magnitude);
        let min_magnitude = W::multiply(greatest, W::splat(MIN_DIRECTION));
        let inverse = [
            clamped_inverse::<W>(direction[0], min_magnitude),
            clamped_inverse::<W>(direction[1], min_magnitude),
            clamped_inverse::<W>(direction[2], min_magnitude),
        ];
        let ends = W::load(ends);
        let regular = regular::<W>(&origin, &magnitude, &inverse, (greatest, reach))
            & W::less(W::splat(0.0), ends);
        let t_max = W::select(regular, W::step_down(ends), W::splat(-1.0));
        let [lower_offset, upper_offset] = offsets::<W>(&origin, &inverse);
        // The axis of the greatest component; of equal components, the first.
        let x = W::less_equal(greatest, magnitude[0]);
        let y = W::less_equal(greatest, magnitude[1]) & !x;
        let z = !(x | y);
        let slope = ordered::<W>(&direction, (x, y));
        let inverse_z = ordered::<W>(&inverse, (x, y))[2];
        Self {
            inverse,
            lower_offset,
            upper_offset,
            axes: [W::axes(x, y), W::axes(z, x), W::axes(y, z)],
            origin: ordered::<W>(&origin, (x, y)),
            shear: [W::multiply(slope[0], inverse_z), W::multiply(slope[1], inverse_z), inverse_z],
            t_max,
            regular,
        }
    }

    /// The rays that meet the box of a node's child within `limit`, and the distances where they
    /// enter it. The slot must not be empty.
    #[inline(always)]
    pub(super) fn meet(&self, node: &Node, slot: usize, limit: W::Vector) -> (u32, W::Vector) {
        // The sign of the direction decides whether the lower plane is the near or the far one; so
        // does the order of the distances.
        let (x, y, z) =
            (self.slab(node, slot, 0), self.slab(node, slot, 1), self.slab(node, slot, 2));
        let enter = W::max(W::max(x.0, y.0), W::max(z.0, W::splat(0.0)));
        let leave = W::min(W::min(x.1, y.1), W::min(z.1, limit));
        (W::less_equal(enter, leave), enter)
    }
    /// The distances where the rays enter and leave a child's box along one axis.
    #[inline(always)]
    fn slab(&self, node: &Node, slot: usize, axis: usize) -> (W::Vector, W::Vector) {
        let lower = W::splat(node.planes[2 * axis].0[slot]);
        let upper = W::splat(node.planes[2 * axis + 1].0[slot]);
        let lower = W::multiply_add(lower, self.inverse[axis], self.lower_offset[axis]);
        let upper = W::multiply_add(upper, self.inverse[axis], self.upper_offset[axis]);
        (W::min(lower, upper), W::max(lower, upper))
    }
}

#[inline(always)]
fn absolute<W: Wide>([x, y, z]: &[W::Vector; 3]) -> [W::Vector; 3] {
    [W::abs(*x), W::abs(*y), W::abs(*z)]
}

#[inline(always)]
fn max_of<W: Wide>(of: &[W::Vector; 3]) -> W::Vector {
    W::max(W::max(of[0], of[1]), of[2])
}

#[inline(always)]
fn sum_of<W: Wide>(of: &[W::Vector; 3]) -> W::Vector {
    W::add(of[0], W::add(of[1], of[2]))
}

/// The inverse of a component that is clamped away from zero.
#[inline(always)]
fn clamped_inverse<W: Wide>(component: W::Vector, min_magnitude: W::Vector) -> W::Vector {
    let magnitude = W::max(W::abs(component), min_magnitude);
    W::divide(W::splat(1.0), W::copysign(magnitude, component))
}

/// Cyclic order with the axis of the greatest component last: y z x in the lanes of `on_x`, z x y
/// in those of `on_y`, x y z elsewhere.
#[inline(always)]
fn ordered<W: Wide>([x, y, z]: &[W::Vector; 3], (on_x, on_y): (u32, u32)) -> [W::Vector; 3] {
    [
        W::select(on_x, *y, W::select(on_y, *z, *x)),
        W::select(on_x, *z, W::select(on_y, *x, *y)),
        W::select(on_x, *x, W::select(on_y, *y, *z)),
    ]
}

/// The rays of a packet in columns: the coordinates of origins and directions, and the ends.
pub(super) struct Columns(pub(super) [Row; 7]);

impl Columns {
    /// No rays: the ends are zero.
    pub(super) const EMPTY: Self = Self([Row([0.0; MAX_LANES]); 7]);

    /// Writes the rays of a packet. This should happen some time before they are loaded, because
    /// the processor cannot forward several scalar stores to one wide load.
    #[inline(always)]
    pub(super) fn fill<W: Wide>(&mut self, rays: &[Ray]) {
        self.0[6] = Row([0.0; MAX_LANES]);
        for (lane, ray) in rays.iter().enumerate().take(W::LANES) {
            let (origin, direction) = (ray.origin, ray.direction);
            self.0[0].0[lane] = origin.x;
            self.0[1].0[lane] = origin.y;
            self.0[2].0[lane] = origin.z;
            self.0[3].0[lane] = direction.x;
            self.0[4].0[lane] = direction.y;
            self.0[5].0[lane] = direction.z;
            self.0[6].0[lane] = ray.t_max;
        }
    }
}

/// The rays whose distances to everything are finite.
#[inline(always)]
fn regular<W: Wide>(
    origin: &[W::Vector; 3],
    magnitude: &[W::Vector; 3],
    inverse: &[W::Vector; 3],
    (greatest, reach): (W::Vector, f32),
) -> u32 {
    let extent = W::add(sum_of::<W>(&absolute::<W>(origin)), W::splat(reach));
    let distance = W::multiply(extent, sum_of::<W>(&absolute::<W>(inverse)));
    W::less_equal(sum_of::<W>(magnitude), W::splat(f32::MAX))
        & W::less_equal(W::splat(f32::MIN_POSITIVE), greatest)
        & W::less(distance, W::splat(MAX_DISTANCE))
}

/// The offsets of lower and upper planes, each padded away from the box.
#[inline(always)]
fn offsets<W: Wide>(origin: &[W::Vector; 3], inverse: &[W::Vector; 3]) -> [[W::Vector; 3]; 2] {
    let greatest = max_of::<W>(&absolute::<W>(origin));
    let padding = W::multiply(greatest, W::splat(PADDING));
    let x = offset::<W>(origin[0], inverse[0], padding);
    let y = offset::<W>(origin[1], inverse[1], padding);
    let z = offset::<W>(origin[2], inverse[2], padding);
    [[x.0, y.0, z.0], [x.1, y.1, z.1]]
}

#[inline(always)]
fn offset<W: Wide>(
    origin: W::Vector,
    inverse: W::Vector,
    padding: W::Vector,
) -> (W::Vector, W::Vector) {
    let offset = W::subtract(W::splat(0.0), W::multiply(origin, inverse));
    // With the sign of the direction: this moves either plane away from the box.
    let padding = W::multiply(padding, inverse);
    (W::subtract(offset, padding), W::add(offset, padding))
}
