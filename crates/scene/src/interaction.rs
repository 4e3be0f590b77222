//! What is known where a ray has met a surface.

use crate::ids::{InstanceId, ShapeId};
use etendue_math::{Frame, Ray, offset_ray_origin};
use glam::{Vec2, Vec3};

/// A point on a surface, with everything that materials, textures and emitters ask about it.
/// All vectors are in world space except [`wi`](Self::wi).
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// The point.
    pub point: Vec3,
    /// A bound of the absolute error of each coordinate of `point`.
    pub error: Vec3,
    /// The ray parameter of the hit.
    pub t: f32,
    /// The unit geometric normal, on the side that the shape calls its front.
    pub normal: Vec3,
    /// The shading frame; its `n` is on the side of [`normal`](Self::normal).
    pub shading: Frame,
    /// Surface coordinates.
    pub uv: Vec2,
    /// ∂point/∂u.
    pub dp_du: Vec3,
    /// ∂point/∂v.
    pub dp_dv: Vec3,
    /// The unit direction that the path came from, away from the surface, in the shading frame.
    pub wi: Vec3,
    /// The shape.
    pub shape: ShapeId,
    /// Which of the shape's primitives (triangles) was hit.
    pub primitive: u32,
    /// Barycentric coordinates of the second and third vertex, where the primitive is a triangle.
    pub barycentric: Vec2,
    /// The instance through which the shape was hit.
    pub instance: Option<InstanceId>,
}

impl SurfaceInteraction {
    /// Surface coordinates alone, for textures that are looked up off any surface.
    #[must_use]
    pub fn at_uv(uv: Vec2, shading: Frame) -> Self {
        Self {
            point: Vec3::ZERO,
            error: Vec3::ZERO,
            t: 0.0,
            normal: shading.n,
            shading,
            uv,
            dp_du: shading.s,
            dp_dv: shading.t,
            wi: Vec3::Z,
            shape: ShapeId(0),
            primitive: 0,
            barycentric: Vec2::ZERO,
            instance: None,
        }
    }

    /// World to shading coordinates.
    #[inline(always)]
    #[must_use]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        self.shading.to_local(v)
    }

    /// Shading to world coordinates.
    #[inline(always)]
    #[must_use]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.shading.to_world(v)
    }

    /// An unbounded ray that leaves the surface towards the world direction `direction`.
    #[inline(always)]
    #[must_use]
    pub fn spawn_ray(&self, direction: Vec3) -> Ray {
        Ray::new(offset_ray_origin(self.point, self.error, self.normal, direction), direction)
    }
}
