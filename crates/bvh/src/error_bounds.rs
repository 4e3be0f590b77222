//! How far rounding can move things, and the enlargement of boxes that makes up for it.
//!
//! Let ε = 2⁻²⁴ and count to first order; z is the axis of the direction's greatest component.
//!
//! * The triangle test sees a vertex `v` from the origin `o` at the sheared position
//!   `fl(fl(vₓ-oₓ) - fl(S·fl(v_z-o_z)))`, `S = fl(dₓ·fl(1/d_z))`, `|S| ≤ 1`: at most
//!   `ε·(2|vₓ-oₓ| + 5|v_z-o_z|)` off. So where it reports a hit, a point of the triangle lies that
//!   near to the ray.
//! * The box test finds the distance of a plane `p` as `fl(fl(p·r) + c)`, `r = fl(1/dₓ)`,
//!   `c = fl(-o·r)`, or with one rounding less where it is fused: that of a plane at most
//!   `ε·(2|p-o| + |p| + |o|)` away.
//! * The distance that the triangle test reports is off by at most `ε·9·|v_z-o_z|`, and a box must
//!   not be passed over for a hit that is nearer by less than that.
//!
//! As `p` is a coordinate of some vertex, all of them together are at most `19·ε·(|v| + |o|)`, with
//! `|·|` the greatest coordinate by magnitude. The part with `v` is added to boxes when they are
//! stored; the part with `o` once per ray, to the constants of the box test. So the traversal pays
//! nothing for it, and a large ground plane does not blur the small things that stand on it.

use etendue_math::Bounds3;
use glam::Vec3;

/// The enlargement of boxes in units of the greatest coordinate: 19 ε, and some for spatial
/// splits and the terms of second order.
pub(crate) const PADDING: f32 = 20.5 / 16_777_216.0;

/// Directions are held off zero by this part of their greatest component: a box is then hit at
/// worst 2⁻⁴⁰ of the distance away from where it would be, far less than [`PADDING`].
pub(crate) const LEAST_DIRECTION: f32 = 1.0 / 1_099_511_627_776.0;

/// The box as it is stored in a node: see the module.
pub(crate) fn padded(bounds: Bounds3) -> Bounds3 {
    let greatest = bounds.min.abs().max(bounds.max.abs()).max_element();
    // The least normal number stands in where the product would underflow.
    let padding = Vec3::splat((greatest * PADDING).max(f32::MIN_POSITIVE));
    Bounds3::new(bounds.min - padding, bounds.max + padding)
}
