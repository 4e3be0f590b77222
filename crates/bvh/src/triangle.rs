//! The watertight triangle test, for eight triangles at once.
//!
//! After Woop, Benthin and Wald, *Watertight Ray/Triangle Intersection* (JCGT 2013): vertices are
//! translated to the ray's origin and sheared so that the ray runs along an axis. The signs of
//! three two-dimensional edge functions then tell whether the ray passes inside.
//!
//! * The sheared position of a vertex depends on the vertex and the ray alone. Triangles that share
//!   a vertex see it at the same position, so the sheared mesh has no gaps.
//! * An edge function is `fl(a·b) - fl(c·d)`, without fused operations. Rounding is monotonic: a
//!   positive result means `a·b > c·d` exactly, a negative one the opposite, and the neighbouring
//!   triangle gets exactly the opposite sign. Zero is undecided and counts as inside for both
//!   neighbours.
//! * If the sum of the three is zero, or close to underflow or overflow, they are computed again
//!   from the same sheared positions in `f64`, where the products are exact.
//!
//! So a triangle is hit wherever the exact test of the sheared mesh would hit it.

use crate::node::{F32x8, TriangleBlock, WIDTH};
use crate::simd::Simd;
use crate::simd::portable::Portable;
use crate::traverse::ray::RayConstants;

/// The result for the lanes that single precision cannot decide, computed in double precision.
pub(crate) struct Resolved {
    /// A bit for each lane that is hit with `0 < t ≤ t_max`.
    pub(crate) mask: u32,
    /// The distance in each lane.
    pub(crate) t: F32x8,
    /// The edge function opposite vertex 1, divided by the sum of all three.
    pub(crate) v: F32x8,
    /// The edge function opposite vertex 2, divided by the sum of all three.
    pub(crate) w: F32x8,
}

/// Eight sheared vertices: two coordinates across the ray, and the distance along it.
type Sheared<S> = [<S as Simd>::Vector; 3];

/// The result for a block in which some lane may be hit. `v` and `w` are divided by the determinant
/// only at the end of the traversal.
pub(crate) struct Candidates<S: Simd> {
    /// A bit for each lane that is certainly hit with `0 < t ≤ t_max`.
    pub(crate) mask: u32,
    /// The lanes that single precision cannot decide.
    pub(crate) uncertain: u32,
    /// The distance in each lane that is certainly hit, infinity in the others.
    pub(crate) t: S::Vector,
    /// The edge function opposite vertex 1.
    pub(crate) v: S::Vector,
    /// The edge function opposite vertex 2.
    pub(crate) w: S::Vector,
    /// The sum of the three edge functions.
    pub(crate) determinant: S::Vector,
}

/// Below this determinant, the edge functions lose precision to underflow.
pub(crate) const MIN_DETERMINANT: f32 = 1e-30;
/// Above this determinant, its inverse loses precision to underflow.
pub(crate) const MAX_DETERMINANT: f32 = 1e37;

/// Tests a block against the ray. Returns `None` if the ray misses all lanes.
#[inline(always)]
pub(crate) fn intersect_block<S: Simd>(
    block: &TriangleBlock,
    ray: &RayConstants,
    t_max: f32,
) -> Option<Candidates<S>> {
    let a = shear::<S>(block, 0, ray);
    let b = shear::<S>(block, 1, ray);
    let c = shear::<S>(block, 2, ray);
    let u = edge_function::<S>(&c, &b);
    let v = edge_function::<S>(&a, &c);
    let w = edge_function::<S>(&b, &a);
    // Outside if edge functions have both signs. The order of the operands makes `min` and `max`
    // ignore a NaN; the sum detects it below.
    let zero = S::splat(0.0);
    let min = S::min(u, S::min(v, w));
    let max = S::max(u, S::max(v, w));
    let outside = S::and(S::less(min, zero), S::less(zero, max));
    let inside = !S::bitmask(outside) & 0xff;
    if inside == 0 {
        return None;
    }
    let determinant = S::add(u, S::add(v, w));
    let magnitude = S::abs(determinant);
    let certain = S::and(
        S::less(S::splat(MIN_DETERMINANT), magnitude),
        S::less(magnitude, S::splat(MAX_DETERMINANT)),
    );
    // A single division at the end would shorten the critical path, but only primary rays were
    // faster (2 %), and the products would overflow sooner.
    let inverse = S::divide(S::splat(1.0), determinant);
    let along =
        |edge: S::Vector, vertex: &Sheared<S>| S::multiply(S::multiply(edge, inverse), vertex[2]);
    let t = S::add(along(u, &a), S::add(along(v, &b), along(w, &c)));
    let within = S::and(S::less(zero, t), S::less_equal(t, S::splat(t_max)));
    let hit = S::and(S::and_not(certain, outside), within);
    Some(Candidates {
        mask: S::bitmask(hit),
        uncertain: inside & !S::bitmask(certain),
        t: S::select(hit, t, S::splat(f32::INFINITY)),
        v,
        w,
        determinant,
    })
}

impl<S: Simd> Candidates<S> {
    /// Whether any lane is hit.
    #[inline(always)]
    pub(crate) fn any(&self, block: &TriangleBlock, ray: &RayConstants, t_max: f32) -> bool {
        self.mask != 0
            || (self.uncertain != 0 && resolve(self.uncertain, block, ray, t_max).mask != 0)
    }

    /// Decides the uncertain lanes. `block` must be the one that was tested.
    #[inline(always)]
    pub(crate) fn resolve(
        &self,
        block: &TriangleBlock,
        ray: &RayConstants,
        t_max: f32,
    ) -> Resolved {
        resolve(self.uncertain, block, ray, t_max)
    }
}

#[inline(always)]
fn shear<S: Simd>(block: &TriangleBlock, vertex: usize, ray: &RayConstants) -> Sheared<S> {
    let x = S::subtract(S::load(ray.coordinate(block, vertex, 0)), S::splat(ray.origin[0]));
    let y = S::subtract(S::load(ray.coordinate(block, vertex, 1)), S::splat(ray.origin[1]));
    let z = S::subtract(S::load(ray.coordinate(block, vertex, 2)), S::splat(ray.origin[2]));
    [
        S::subtract(x, S::multiply(S::splat(ray.shear[0]), z)),
        S::subtract(y, S::multiply(S::splat(ray.shear[1]), z)),
        S::multiply(S::splat(ray.shear[2]), z),
    ]
}

#[inline(always)]
fn edge_function<S: Simd>(p: &Sheared<S>, q: &Sheared<S>) -> S::Vector {
    S::subtract(S::multiply(p[0], q[1]), S::multiply(p[1], q[0]))
}

/// Decides the lanes of `uncertain` in `f64`. Rare: the ray meets a triangle edge-on, or the
/// coordinates are so large or small that products overflow or underflow in `f32`.
///
/// The sheared positions are recomputed: keeping them took registers from the common path. They
/// are the same in every tier.
#[cold]
#[inline(never)]
pub(crate) fn resolve(
    uncertain: u32,
    block: &TriangleBlock,
    ray: &RayConstants,
    t_max: f32,
) -> Resolved {
    let vertices = [0, 1, 2].map(|vertex| shear::<Portable>(block, vertex, ray).map(F32x8));
    let none = F32x8([0.0; WIDTH]);
    let mut hits = Resolved { mask: 0, t: none, v: none, w: none };
    for lane in (0..WIDTH).filter(|lane| uncertain >> lane & 1 != 0) {
        let [a, b, c] = [0, 1, 2].map(|k| vertices[k].each_ref().map(|x| f64::from(x.0[lane])));
        let edge_function = |p: [f64; 3], q: [f64; 3]| p[0] * q[1] - p[1] * q[0];
        let (u, v, w) = (edge_function(c, b), edge_function(a, c), edge_function(b, a));
        let determinant = u + v + w;
        let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        let t = ((u * a[2] + v * b[2] + w * c[2]) / determinant) as f32;
        if inside && determinant != 0.0 && t > 0.0 && t <= t_max {
            hits.mask |= 1 << lane;
            hits.t.0[lane] = t;
            hits.v.0[lane] = (v / determinant) as f32;
            hits.w.0[lane] = (w / determinant) as f32;
        }
    }
    hits
}
