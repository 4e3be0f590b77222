//! Rays, and offsets of their origins from surfaces.

use crate::lanes::{Lanes, Real, Simd, Vector3};
use glam::Vec3;

/// A half-line `origin + t · direction` for `t` in `(0, t_max)`.
///
/// There is no lower bound other than zero: rays that leave a surface start at an origin that
/// [`offset_ray_origin`] has moved off it, so no global epsilon is needed at any scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The origin.
    pub origin: Vec3,
    /// The direction; not necessarily of unit length. `t` is in units of its length.
    pub direction: Vec3,
    /// Hits at or beyond this parameter do not count; infinite for an unbounded ray.
    pub t_max: f32,
}

impl Ray {
    /// An unbounded ray.
    #[inline(always)]
    #[must_use]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_max: f32::INFINITY }
    }

    /// A ray that ends at `origin + t_max · direction`.
    #[inline(always)]
    #[must_use]
    pub fn segment(origin: Vec3, direction: Vec3, t_max: f32) -> Self {
        Self { origin, direction, t_max }
    }

    /// The point at parameter `t`.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// A [`Ray`] over any [`Real`]: one ray per lane.
#[derive(Clone, Copy, Debug)]
pub struct RayLanes<R> {
    /// The origins.
    pub origin: Vector3<R>,
    /// The directions.
    pub direction: Vector3<R>,
    /// Hits at or beyond these parameters do not count.
    pub t_max: R,
}

impl From<RayLanes<f32>> for Ray {
    #[inline(always)]
    fn from(ray: RayLanes<f32>) -> Self {
        Self { origin: ray.origin.into(), direction: ray.direction.into(), t_max: ray.t_max }
    }
}

impl<S: Simd> RayLanes<Lanes<S>> {
    /// The ray of one lane.
    #[inline(always)]
    #[must_use]
    pub fn lane(&self, lane: usize) -> Ray {
        Ray {
            origin: self.origin.lane(lane),
            direction: self.direction.lane(lane),
            t_max: self.t_max.lane(lane),
        }
    }
}

/// The origin of a ray that leaves the surface at `point` towards `direction`, moved off the
/// surface.
///
/// `error` bounds the absolute error of each coordinate of `point`, so the true surface passes
/// through the box `point ± error`. The origin is moved along the geometric `normal`, to the side
/// that `direction` points to, just out of that box. Then each coordinate is rounded away from the
/// surface (Pharr, Jakob and Humphreys, *Physically Based Rendering*, 4th ed., section 6.8.6).
#[inline(always)]
#[must_use]
pub fn offset_ray_origin(point: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    offset_origin_lanes(point.into(), error.into(), normal.into(), direction.into()).into()
}

/// As [`offset_ray_origin`], over any [`Real`].
#[inline(always)]
#[must_use]
pub fn offset_origin_lanes<R: Real>(
    point: Vector3<R>,
    error: Vector3<R>,
    normal: Vector3<R>,
    direction: Vector3<R>,
) -> Vector3<R> {
    let distance = normal.abs().dot(error);
    let zero = distance.zero();
    let distance = R::select(direction.dot(normal).lt(zero), -distance, distance);
    let offset = normal * distance;
    let moved = point + offset;
    Vector3::new(
        moved.x.next_towards(offset.x),
        moved.y.next_towards(offset.y),
        moved.z.next_towards(offset.z),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_origin_is_outside_the_error_box_on_the_side_of_the_direction() {
        for scale in [1e-6_f32, 1.0, 1e6] {
            let normal = Vec3::new(1.0, 2.0, -2.0) / 3.0;
            let point = Vec3::new(0.3, -0.7, 0.2) * scale;
            let error = Vec3::splat(3e-7 * scale);
            for side in [1.0, -1.0] {
                let origin = offset_ray_origin(point, error, normal, normal * side);
                let clearance = (origin - point).dot(normal) * side;
                assert!(clearance > 0.0, "scale {scale}, side {side}: {clearance}");
            }
        }
    }
}
