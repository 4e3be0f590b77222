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

/// A placed group. A scene may have millions, so both transforms are stored without padding.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// The group.
    pub group: GroupId,
    to_world: [Vec3; 4],
    to_local: [Vec3; 4],
}

impl Instance {
    /// Places a group.
    #[must_use]
    pub fn new(group: GroupId, to_world: &Transform) -> Self {
        let [to_world, to_local] = [to_world.affine(), to_world.inverse_affine()].map(|map| {
            let matrix = map.matrix3;
            [matrix.x_axis, matrix.y_axis, matrix.z_axis, map.translation].map(Vec3::from)
        });
        Self { group, to_world, to_local }
    }

    /// Group space to world space.
    #[must_use]
    pub fn to_world(&self) -> Transform {
        let [to_world, to_local] = [self.to_world, self.to_local]
            .map(|[x, y, z, w]| Affine3A::from_cols(x.into(), y.into(), z.into(), w.into()));
        Transform::from_inverses(to_world, to_local)
    }

    /// The world-space bounding box.
    #[must_use]
    pub fn bounds(&self, group: &Group) -> Bounds3 {
        self.to_world().bounds(&group.bvh.bounds())
    }

    /// Transforms an interaction from group space to world space. `direction` is that of the world
    /// ray.
    #[must_use]
    pub fn place(&self, local: SurfaceInteraction, direction: Vec3) -> SurfaceInteraction {
        let to_world = &self.to_world();
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

/// A bound on the error of a transformed point: the transformed bound plus the rounding error of
/// the sums (*Physically Based Rendering*, 4th ed., section 6.8.6).
fn transformed_error(map: Affine3A, point: Vec3, error: Vec3) -> Vec3 {
    let columns =
        [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis].map(|c| Vec3::from(c).abs());
    let gamma = rounding_error_bound(4);
    let spread = |v: Vec3| columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
    spread(error) * (1.0 + gamma)
        + (spread(point.abs()) + Vec3::from(map.translation).abs()) * gamma
}
