//! The test of [`crate::triangle`] for a block of triangles against a packet: one ray per lane, one
//! triangle after another.
//!
//! First, all triangles are tested for rays that pass inside, without a branch on the outcome,
//! which is unpredictable. Then distances are computed for the triangles that some ray passes
//! through.

use super::rays::Packet;
use crate::node::{TriangleBlock, WIDTH};
use crate::simd::wide::{Row, Wide};
use crate::triangle::{MAX_DETERMINANT, MIN_DETERMINANT};
use std::mem::MaybeUninit;

/// The triangles of a block that some rays pass through, at any distance.
pub(super) struct Survivors {
    /// The three edge functions, then the distances of the vertices along the ray's axis.
    rows: [[MaybeUninit<Row>; 6]; WIDTH],
    /// The rays that pass through each triangle.
    lanes: [u32; WIDTH],
    /// The indices of the triangles in the block.
    triangles: [usize; WIDTH],
    count: usize,
}

/// A triangle that some ray may hit.
pub(super) struct Candidates<W: Wide> {
    /// The index of the triangle in the block.
    pub(super) triangle: usize,
    /// The rays that certainly hit it with `0 < t ≤ limit`.
    pub(super) mask: u32,
    /// The rays that single precision cannot decide.
    pub(super) uncertain: u32,
    /// The distances.
    pub(super) t: W::Vector,
    /// The edge functions opposite vertex 1.
    pub(super) v: W::Vector,
    /// The edge functions opposite vertex 2.
    pub(super) w: W::Vector,
    /// The sums of the three edge functions.
    pub(super) determinant: W::Vector,
}

impl Survivors {
    /// An empty list.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            rows: [[const { MaybeUninit::uninit() }; 6]; WIDTH],
            lanes: [0; WIDTH],
            triangles: [0; WIDTH],
            count: 0,
        }
    }

    /// Finds the triangles of a block that rays of `lanes` pass through. (In place, to avoid a copy
    /// of the list.)
    #[inline(always)]
    pub(super) fn find<W: Wide>(&mut self, block: &TriangleBlock, rays: &Packet<W>, lanes: u32) {
        let mut count = 0;
        let [a, b, c] = &block.vertices;
        let vertices = [W::vertex(a), W::vertex(b), W::vertex(c)];
        for triangle in 0..WIDTH {
            if !block.is_used(triangle) {
                break;
            }
            let a = place(vertices[0], triangle, rays);
            let b = place(vertices[1], triangle, rays);
            let c = place(vertices[2], triangle, rays);
            let (near_a, near_b, near_c) = (shear(&a, rays), shear(&b, rays), shear(&c, rays));
            let u = edge_function::<W>(near_c, near_b);
            let v = edge_function::<W>(near_a, near_c);
            let w = edge_function::<W>(near_b, near_a);
            let zero = W::splat(0.0);
            let min = W::min(u, W::min(v, w));
            let max = W::max(u, W::max(v, w));
            let inside = lanes & !(W::less(min, zero) & W::less(zero, max));
            // The next triangle overwrites this entry if no ray passes inside.
            let rows = &mut self.rows[count & (WIDTH - 1)];
            rows[0].write(W::store(u));
            rows[1].write(W::store(v));
            rows[2].write(W::store(w));
            rows[3].write(W::store(a[2]));
            rows[4].write(W::store(b[2]));
            rows[5].write(W::store(c[2]));
            self.lanes[count & (WIDTH - 1)] = inside;
            self.triangles[count & (WIDTH - 1)] = triangle;
            count += usize::from(inside != 0);
        }
        self.count = count;
    }

    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Computes where the rays hit the survivor with this index, which must be below the count.
    #[inline(always)]
    pub(super) fn hits<W: Wide>(
        &self,
        number: usize,
        rays: &Packet<W>,
        limit: W::Vector,
    ) -> Candidates<W> {
        assert!(number < self.count && number < WIDTH);
        let rows = &self.rows[number];
        // SAFETY: `find` has written all six rows below `count`.
        let row = |which: usize| W::load(unsafe { rows[which].assume_init_ref() });
        let (u, v, w) = (row(0), row(1), row(2));
        let determinant = W::add(u, W::add(v, w));
        let magnitude = W::abs(determinant);
        let certain = W::less(W::splat(MIN_DETERMINANT), magnitude)
            & W::less(magnitude, W::splat(MAX_DETERMINANT));
        let inverse = W::divide(W::splat(1.0), determinant);
        let u_along = along(W::multiply(u, inverse), row(3), rays);
        let v_along = along(W::multiply(v, inverse), row(4), rays);
        let w_along = along(W::multiply(w, inverse), row(5), rays);
        let t = W::add(u_along, W::add(v_along, w_along));
        let within = W::less(W::splat(0.0), t) & W::less_equal(t, limit);
        Candidates {
            triangle: self.triangles[number],
            mask: self.lanes[number] & certain & within,
            uncertain: self.lanes[number] & !certain,
            t,
            v,
            w,
            determinant,
        }
    }
}

/// A vertex relative to the origins, in the order of the rays' axes.
#[inline(always)]
fn place<W: Wide>(vertex: W::Vertex<'_>, triangle: usize, rays: &Packet<W>) -> [W::Vector; 3] {
    [
        W::subtract(W::coordinate(vertex, triangle, rays.axes[0]), rays.origin[0]),
        W::subtract(W::coordinate(vertex, triangle, rays.axes[1]), rays.origin[1]),
        W::subtract(W::coordinate(vertex, triangle, rays.axes[2]), rays.origin[2]),
    ]
}

/// The sheared coordinates across the rays.
#[inline(always)]
fn shear<W: Wide>(place: &[W::Vector; 3], rays: &Packet<W>) -> [W::Vector; 2] {
    [
        W::subtract(place[0], W::multiply(rays.shear[0], place[2])),
        W::subtract(place[1], W::multiply(rays.shear[1], place[2])),
    ]
}

/// A vertex's contribution to the distance along the rays.
#[inline(always)]
fn along<W: Wide>(weight: W::Vector, place: W::Vector, rays: &Packet<W>) -> W::Vector {
    W::multiply(weight, W::multiply(rays.shear[2], place))
}

#[inline(always)]
fn edge_function<W: Wide>(p: [W::Vector; 2], q: [W::Vector; 2]) -> W::Vector {
    W::subtract(W::multiply(p[0], q[1]), W::multiply(p[1], q[0]))
}
