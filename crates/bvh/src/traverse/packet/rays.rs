//! What the tests need of the rays of a packet, computed once per packet.
//!
//! Everything has the bits that [`RayConstants`](super::super::ray::RayConstants) and
//! [`BoxConstants`](super::super::ray::BoxConstants) have for the single ray.

use crate::error_bounds::{LEAST_DIRECTION, PADDING};
use crate::node::Node;
use crate::simd::wide::{MOST, Row, Wide};
use etendue_math::Ray;

/// The constants of the box test and of the triangle test.
pub(super) struct Packet<W: Wide> {
    /// One over the directions, whose components are held off zero.
    inverse: [W::Vector; 3],
    /// What is added to the distances of a box's lower planes.
    lower_offset: [W::Vector; 3],
    /// What is added to the distances of a box's upper planes.
    upper_offset: [W::Vector; 3],
    /// The two minor axes, then those of the directions' greatest components.
    pub(super) axes: [W::Axes; 3],
    /// The origins, in the order of `axes`.
    pub(super) origin: [W::Vector; 3],
    /// The slopes along the minor axes, then one over the greatest components.
    pub(super) shear: [W::Vector; 3],
    /// The greatest distances that count; below zero in lanes that are not `ordinary`.
    pub(super) t_max: W::Vector,
    /// The lanes with a ray whose distances from everything in the tree are finite, with room to
    /// spare. Others are left to the single ray, and so the tests need not care for what is not a
    /// number.
    pub(super) ordinary: u32,
}

/// Distances up to here leave room for the sums and products of the box test.
const GREATEST_DISTANCE: f32 = 1e36;

impl<W: Wide> Packet<W> {
    /// Takes rays through a tree whose coordinates are at most `reach`.
    #[inline(always)]
    pub(super) fn new(columns: &Columns, reach: f32) -> Self {
        let Columns([ox, oy, oz, dx, dy, dz, ends]) = columns;
        let origin = [W::load(ox), W::load(oy), W::load(oz)];
        let direction = [W::load(dx), W::load(dy), W::load(dz)];
        let size = absolute::<W>(&direction);
        let greatest = greatest_of::<W>(&size);
        let least = W::multiply(greatest, W::splat(LEAST_DIRECTION));
        let inverse = [
            held_off_zero::<W>(direction[0], least),
            held_off_zero::<W>(direction[1], least),
            held_off_zero::<W>(direction[2], least),
        ];
        let ends = W::load(ends);
        let ordinary = ordinary::<W>(&origin, &size, &inverse, (greatest, reach))
            & W::less(W::splat(0.0), ends);
        let t_max = W::select(ordinary, W::step_down(ends), W::splat(-1.0));
        let [lower_offset, upper_offset] = offsets::<W>(&origin, &inverse);
        // The greatest component is on x where x is, else on y where y is, else on z.
        let x = W::less_equal(greatest, size[0]);
        let y = W::less_equal(greatest, size[1]) & !x;
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
            ordinary,
        }
    }

    /// Which rays meet the box of a node's child within `limit`, and where they enter it. The slot
    /// must not be empty.
    #[inline(always)]
    pub(super) fn meet(&self, node: &Node, slot: usize, limit: W::Vector) -> (u32, W::Vector) {
        // The lower plane is the near one or the far one as the direction's sign says, which the
        // order of the distances tells as well.
        let (x, y, z) =
            (self.slab(node, slot, 0), self.slab(node, slot, 1), self.slab(node, slot, 2));
        let enter = W::greatest(W::greatest(x.0, y.0), W::greatest(z.0, W::splat(0.0)));
        let leave = W::least(W::least(x.1, y.1), W::least(z.1, limit));
        (W::less_equal(enter, leave), enter)
    }
}

impl<W: Wide> Packet<W> {
    /// Where the rays enter and leave a child's box on one axis.
    #[inline(always)]
    fn slab(&self, node: &Node, slot: usize, axis: usize) -> (W::Vector, W::Vector) {
        let lower = W::splat(node.planes[2 * axis].0[slot]);
        let upper = W::splat(node.planes[2 * axis + 1].0[slot]);
        let lower = W::multiply_add(lower, self.inverse[axis], self.lower_offset[axis]);
        let upper = W::multiply_add(upper, self.inverse[axis], self.upper_offset[axis]);
        (W::least(lower, upper), W::greatest(lower, upper))
    }
}

#[inline(always)]
fn absolute<W: Wide>([x, y, z]: &[W::Vector; 3]) -> [W::Vector; 3] {
    [W::absolute(*x), W::absolute(*y), W::absolute(*z)]
}

#[inline(always)]
fn greatest_of<W: Wide>(of: &[W::Vector; 3]) -> W::Vector {
    W::greatest(W::greatest(of[0], of[1]), of[2])
}

#[inline(always)]
fn sum_of<W: Wide>(of: &[W::Vector; 3]) -> W::Vector {
    W::add(of[0], W::add(of[1], of[2]))
}

/// One over a component that is held off zero.
#[inline(always)]
fn held_off_zero<W: Wide>(component: W::Vector, least: W::Vector) -> W::Vector {
    let held = W::greatest(W::absolute(component), least);
    W::divide(W::splat(1.0), W::with_sign(held, component))
}

/// In cyclic order with the axis of the greatest component last: y z x where that is x, z x y where
/// it is y, and x y z elsewhere.
#[inline(always)]
fn ordered<W: Wide>([x, y, z]: &[W::Vector; 3], (on_x, on_y): (u32, u32)) -> [W::Vector; 3] {
    [
        W::select(on_x, *y, W::select(on_y, *z, *x)),
        W::select(on_x, *z, W::select(on_y, *x, *y)),
        W::select(on_x, *x, W::select(on_y, *y, *z)),
    ]
}

/// The coordinates of origins and directions, and the ends, of the rays of a packet.
pub(super) struct Columns(pub(super) [Row; 7]);

impl Columns {
    /// No rays: their ends are not above zero.
    pub(super) const EMPTY: Self = Self([Row([0.0; MOST]); 7]);

    /// Takes the rays of a packet, some time before they are loaded: the processor cannot forward
    /// what is stored number by number to a wide load.
    #[inline(always)]
    pub(super) fn fill<W: Wide>(&mut self, rays: &[Ray]) {
        self.0[6] = Row([0.0; MOST]);
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
fn ordinary<W: Wide>(
    origin: &[W::Vector; 3],
    size: &[W::Vector; 3],
    inverse: &[W::Vector; 3],
    (greatest, reach): (W::Vector, f32),
) -> u32 {
    let places = W::add(sum_of::<W>(&absolute::<W>(origin)), W::splat(reach));
    let distance = W::multiply(places, sum_of::<W>(&absolute::<W>(inverse)));
    W::less_equal(sum_of::<W>(size), W::splat(f32::MAX))
        & W::less_equal(W::splat(f32::MIN_POSITIVE), greatest)
        & W::less(distance, W::splat(GREATEST_DISTANCE))
}

/// The offsets of lower and upper planes: what is enough for the near plane, or the far one.
#[inline(always)]
fn offsets<W: Wide>(origin: &[W::Vector; 3], inverse: &[W::Vector; 3]) -> [[W::Vector; 3]; 2] {
    let greatest = greatest_of::<W>(&absolute::<W>(origin));
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
    // Signed as the direction: away from the near plane, whichever it is.
    let padding = W::multiply(padding, inverse);
    (W::subtract(offset, padding), W::add(offset, padding))
}
