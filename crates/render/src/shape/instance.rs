//! `instance`: a shape group placed in the scene.

use super::shapegroup::Group;
use crate::ids::GroupId;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use etendue_math::{Bounds3, Frame, Transform, rounding_error_bound};
use glam::{Affine3A, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A copy of a `shapegroup` at another place. The group's geometry is kept once, however \
              many instances there are.",
    parameters: &[
        parameter("to_world", "transform", "", "Placement of the group's space."),
        parameter("shapegroup", "shape", "", "The group: nested, or a reference; any name."),
    ],
    sample: r#"<scene><shape type="shapegroup" id="grove"><shape type="sphere"/></shape><shape type="instance"><ref id="grove"/><transform name="to_world"><translate x="5"/></transform></shape></scene>"#,
};

/// A placed group.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// What is placed.
    pub group: GroupId,
    /// The group's space to the world.
    pub to_world: Transform,
    bounds: Bounds3,
}

impl Instance {
    /// Places a group.
    #[must_use]
    pub fn new(id: GroupId, group: &Group, to_world: Transform) -> Self {
        Self { group: id, to_world, bounds: to_world.bounds(&group.bvh.bounds()) }
    }

    /// The box around the placed group.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// Takes an interaction from the group's space to the world. `direction` is that of the world ray.
    #[must_use]
    pub fn place(&self, local: SurfaceInteraction, direction: Vec3) -> SurfaceInteraction {
        let to_world = &self.to_world;
        let unit = |normal: Vec3| to_world.normal(normal).normalize_or(Vec3::Z);
        let dp_du = to_world.vector(local.dp_du);
        let shading = Frame::from_normal_and_tangent(unit(local.shading.n), dp_du);
        SurfaceInteraction {
            point: to_world.point(local.point),
            error: transformed_error(to_world.affine(), local.point, local.error),
            normal: unit(local.normal),
            shading,
            dp_du,
            dp_dv: to_world.vector(local.dp_dv),
            wi: shading.to_local(-direction),
            ..local
        }
    }
}

/// A bound of the error of a transformed point: the mapped bound, and the rounding of the sums
/// (*Physically Based Rendering*, 4th ed., section 6.8.6).
fn transformed_error(map: Affine3A, point: Vec3, error: Vec3) -> Vec3 {
    let columns =
        [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis].map(|c| Vec3::from(c).abs());
    let gamma = rounding_error_bound(4);
    let spread = |v: Vec3| columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
    spread(error) * (1.0 + gamma)
        + (spread(point.abs()) + Vec3::from(map.translation).abs()) * gamma
}
