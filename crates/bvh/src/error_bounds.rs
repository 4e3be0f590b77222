//! Bounds on the rounding errors of the ray tests, and the padding of boxes that covers them.
//!
//! Let ε = 2⁻²⁴, and keep first-order terms only. z is the axis of the direction's greatest
//! component.
//!
//! * The triangle test computes the sheared position of a vertex `v` relative to the origin `o` as
//!   `fl(fl(vₓ-oₓ) - fl(S·fl(v_z-o_z)))` with `S = fl(dₓ·fl(1/d_z))`, `|S| ≤ 1`. The error is at
//!   most `ε·(2|vₓ-oₓ| + 5|v_z-o_z|)`. So where the test reports a hit, some point of the triangle
//!   lies that close to the ray.
//! * The box test computes the distance of a plane `p` as `fl(fl(p·r) + c)` with `r = fl(1/dₓ)`,
//!   `c = fl(-o·r)`, or with one rounding less where multiply and add are fused. The result is the
//!   distance of a plane that is at most `ε·(2|p-o| + |p| + |o|)` away.
//! * The distance that the triangle test reports is off by at most `ε·9·|v_z-o_z|`. A box must not
//!   be culled because of a hit that is nearer by less than that.
//!
//! As `p` is a coordinate of some vertex, the total is at most `19·ε·(|v| + |o|)`, where `|·|` is
//! the greatest coordinate by magnitude. The term in `v` is added to a box when it is stored. The
//! term in `o` is added once per ray, to the constants of the box test. So the traversal pays
//! nothing for it, and a large ground plane does not enlarge the boxes of small objects on it.

use etendue_math::Bounds3;
use glam::{Affine3A, Vec3};

/// The padding of boxes in units of the greatest coordinate: 19 ε, plus a margin for spatial splits
/// and second-order terms.
pub(crate) const PADDING: f32 = 20.5 / 16_777_216.0;

/// The components of directions are clamped to at least this fraction of the greatest component.
/// This moves the point where a ray meets a box by at most 2⁻⁴⁰ of the distance, far less than
/// [`PADDING`].
pub(crate) const MIN_DIRECTION: f32 = 1.0 / 1_099_511_627_776.0;

/// The box as it is stored in a node; see the module documentation.
pub(crate) fn padded(bounds: Bounds3) -> Bounds3 {
    let greatest = bounds.min.abs().max(bounds.max.abs()).max_element();
    // The smallest normal number replaces a product that underflows.
    let padding = Vec3::splat((greatest * PADDING).max(f32::MIN_POSITIVE));
    Bounds3::new(bounds.min - padding, bounds.max + padding)
}

/// The box around a transformed box, padded by the rounding errors of its corners and of the rays
/// that are transformed the other way.
pub(crate) fn transformed_bounds(bounds: Bounds3, to_world: Affine3A) -> Bounds3 {
    if bounds.is_empty() {
        return Bounds3::EMPTY;
    }
    let corner = |index: usize| {
        let pick = |axis: usize| {
            if index >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] }
        };
        to_world.transform_point3(Vec3::new(pick(0), pick(1), pick(2)))
    };
    let world = Bounds3::from_points((0..8).map(corner));
    let matrix = to_world.matrix3;
    let greatest = bounds.min.abs().max(bounds.max.abs());
    let magnitude = Vec3::from(
        matrix.x_axis.abs() * greatest.x
            + matrix.y_axis.abs() * greatest.y
            + matrix.z_axis.abs() * greatest.z
            + to_world.translation.abs(),
    );
    let padding = magnitude * (16.0 * f32::EPSILON);
    Bounds3::new(world.min - padding, world.max + padding)
}
