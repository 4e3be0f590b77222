//! A block of triangles against the rays of a packet: the test of [`crate::triangle`], with a ray
//! in each lane and one triangle after another.
//!
//! First all triangles are tested for rays that pass inside, without a branch on the outcome,
//! which nothing foretells; then distances are found for those triangles that have some.

use super::rays::Packet;
use crate::node::{TriangleBlock, WIDTH};
use crate::simd::wide::{Row, Wide};
use crate::triangle::{GREATEST_SOUND, LEAST_SOUND};
use std::mem::MaybeUninit;

/// The triangles of a block that some rays pass through, before or behind their ends.
pub(super) struct Survivors {
    /// The three edge functions, then the distances of the vertices along the axes.
    rows: [[MaybeUninit<Row>; 6]; WIDTH],
    /// The rays that pass through.
    lanes: [u32; WIDTH],
    /// Their places in the block.
    triangles: [usize; WIDTH],
    count: usize,
}

/// A triangle that some ray may hit.
pub(super) struct Candidates<W: Wide> {
    /// The triangle's place in the block.
    pub(super) triangle: usize,
    /// The rays that hit it for certain, with `0 < t ≤ limit`.
    pub(super) mask: u32,
    /// The rays for which single precision cannot decide.
    pub(super) doubtful: u32,
    /// The distances.
    pub(super) t: W::Vector,
    /// The edge functions opposite to vertex 1.
    pub(super) v: W::Vector,
    /// The edge functions opposite to vertex 2.
    pub(super) w: W::Vector,
    /// The sums of the three edge functions.
    pub(super) determinant: W::Vector,
}

impl Survivors {
    /// None yet.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            rows: [[const { MaybeUninit::uninit() }; 6]; WIDTH],
            lanes: [0; WIDTH],
            triangles: [0; WIDTH],
            count: 0,
        }
    }

    /// Finds the triangles of a block that rays of `lanes` pass through. (In place: a new list
    /// would be copied.)
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
            let least = W::least(u, W::least(v, w));
            let greatest = W::greatest(u, W::greatest(v, w));
            let inside = lanes & !(W::less(least, zero) & W::less(zero, greatest));
            // Overwritten by the next triangle if this one does not survive.
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

    /// How many there are.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Where the rays hit the survivor of this number, which must be below the count.
    #[inline(always)]
    pub(super) fn hits<W: Wide>(
        &self,
        number: usize,
        rays: &Packet<W>,
        limit: W::Vector,
    ) -> Candidates<W> {
        assert!(number < self.count && number < WIDTH);
        let rows = &self.rows[number];
        // SAFETY: `find` has written all six rows of so many numbers.
        let row = |which: usize| W::load(unsafe { rows[which].assume_init_ref() });
        let (u, v, w) = (row(0), row(1), row(2));
        let determinant = W::add(u, W::add(v, w));
        let absolute = W::absolute(determinant);
        let sound =
            W::less(W::splat(LEAST_SOUND), absolute) & W::less(absolute, W::splat(GREATEST_SOUND));
        let inverse = W::divide(W::splat(1.0), determinant);
        let u_along = along(W::multiply(u, inverse), row(3), rays);
        let v_along = along(W::multiply(v, inverse), row(4), rays);
        let w_along = along(W::multiply(w, inverse), row(5), rays);
        let t = W::add(u_along, W::add(v_along, w_along));
        let within = W::less(W::splat(0.0), t) & W::less_equal(t, limit);
        Candidates {
            triangle: self.triangles[number],
            mask: self.lanes[number] & sound & within,
            doubtful: self.lanes[number] & !sound,
            t,
            v,
            w,
            determinant,
        }
    }
}

/// A vertex seen from the origins, on the rays' axes.
#[inline(always)]
fn place<W: Wide>(vertex: W::Vertex<'_>, triangle: usize, rays: &Packet<W>) -> [W::Vector; 3] {
    [
        W::subtract(W::coordinate(vertex, triangle, rays.axes[0]), rays.origin[0]),
        W::subtract(W::coordinate(vertex, triangle, rays.axes[1]), rays.origin[1]),
        W::subtract(W::coordinate(vertex, triangle, rays.axes[2]), rays.origin[2]),
    ]
}

/// The place across the rays.
#[inline(always)]
fn shear<W: Wide>(place: &[W::Vector; 3], rays: &Packet<W>) -> [W::Vector; 2] {
    [
        W::subtract(place[0], W::multiply(rays.shear[0], place[2])),
        W::subtract(place[1], W::multiply(rays.shear[1], place[2])),
    ]
}

/// A vertex's share of the distance along the rays.
#[inline(always)]
fn along<W: Wide>(weight: W::Vector, place: W::Vector, rays: &Packet<W>) -> W::Vector {
    W::multiply(weight, W::multiply(rays.shear[2], place))
}

#[inline(always)]
fn edge_function<W: Wide>(p: [W::Vector; 2], q: [W::Vector; 2]) -> W::Vector {
    W::subtract(W::multiply(p[0], q[1]), W::multiply(p[1], q[0]))
}
