//! Another hierarchy, placed by a transform.

use crate::Bvh;
use etendue_math::{Bounds3, Ray};
use glam::{Affine3A, Vec3};
use std::sync::Arc;

/// One placed group.
#[derive(Clone, Debug)]
pub(crate) struct Instance {
    pub(crate) group: Arc<Bvh>,
    pub(crate) geometry: u32,
    to_local: Affine3A,
}

impl Instance {
    /// `None` where the transform is not finite or has no finite inverse.
    pub(crate) fn new(group: Arc<Bvh>, geometry: u32, to_world: Affine3A) -> Option<Self> {
        let to_local = to_world.inverse();
        (to_world.is_finite() && to_local.is_finite()).then_some(Self { group, geometry, to_local })
    }

    /// The ray in the group's space. Its direction is not made unit again, so `t` stays the same.
    #[inline]
    pub(crate) fn to_local(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.to_local.transform_point3(ray.origin),
            direction: self.to_local.transform_vector3(ray.direction),
            t_max: ray.t_max,
        }
    }
}

/// The box around a transformed box, enlarged by what rounding may move its corners and the rays
/// that are transformed the other way.
pub(crate) fn world_bounds(bounds: Bounds3, to_world: Affine3A) -> Bounds3 {
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
