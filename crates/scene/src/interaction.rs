//! What is known about the point where a ray hits a surface.

use crate::ids::{InstanceId, ShapeId};
use etendue_math::lanes::{Real, Vector3};
use etendue_math::{Frame, Ray, offset_ray_origin};
use glam::{Vec2, Vec3};

/// A point on a surface, with everything that materials, textures and emitters need. All vectors
/// are in world space except [`wi`](Self::wi).
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// The point.
    pub point: Vec3,
    /// A bound on the absolute error of each coordinate of `point`.
    pub error: Vec3,
    /// The ray parameter of the hit.
    pub t: f32,
    /// The unit geometric normal, on the front side of the shape.
    pub normal: Vec3,
    /// The shading frame; its `n` is on the same side as [`normal`](Self::normal).
    pub shading: Frame,
    /// Surface coordinates.
    pub uv: Vec2,
    /// ∂point/∂u.
    pub dp_du: Vec3,
    /// ∂point/∂v.
    pub dp_dv: Vec3,
    /// The unit direction towards the previous vertex of the path, in the shading frame.
    pub wi: Vec3,
    /// The shape.
    pub shape: ShapeId,
    /// The index of the primitive (triangle) that was hit.
    pub primitive: u32,
    /// Barycentric coordinates of the second and third vertex, for triangles.
    pub barycentric: Vec2,
    /// The instance that contains the shape, if any.
    pub instance: Option<InstanceId>,
}

impl SurfaceInteraction {
    /// An interaction with surface coordinates only, to evaluate textures without a surface.
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

    /// Transforms a vector from world to shading coordinates.
    #[inline(always)]
    #[must_use]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        self.shading.to_local(v)
    }

    /// Transforms a vector from shading to world coordinates.
    #[inline(always)]
    #[must_use]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.shading.to_world(v)
    }

    /// An unbounded ray that leaves the surface along the world-space `direction`.
    #[inline(always)]
    #[must_use]
    pub fn spawn_ray(&self, direction: Vec3) -> Ray {
        Ray::new(offset_ray_origin(self.point, self.error, self.normal, direction), direction)
    }
}

/// The point where a ray hits a surface, without the frame and derivatives that callers may not
/// need.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// The point.
    pub point: Vec3,
    /// A bound on the absolute error of each coordinate of `point`.
    pub error: Vec3,
    /// The unit geometric normal.
    pub normal: Vec3,
    /// The shading normal: unit length, or equal to the geometric normal.
    pub shading_normal: Vec3,
    /// Surface coordinates.
    pub uv: Vec2,
    /// ∂point/∂u.
    pub dp_du: Vec3,
    /// ∂point/∂v.
    pub dp_dv: Vec3,
}

/// A point sampled on a shape that emits light.
#[derive(Clone, Copy, Debug)]
pub struct ShapeSample {
    /// The point.
    pub point: Vec3,
    /// A bound on the absolute error of each coordinate of `point`.
    pub error: Vec3,
    /// The unit geometric normal.
    pub normal: Vec3,
    /// The shading normal; it decides which side emits.
    pub shading_normal: Vec3,
    /// Surface coordinates.
    pub uv: Vec2,
    /// The density: per area from [`Shape::sample_area`](crate::shape::Shape::sample_area), per
    /// solid angle from [`Shape::sample_direction`](crate::shape::Shape::sample_direction).
    pub pdf: f32,
}

impl ShapeSample {
    /// The interaction for texture look-ups at this point, seen along `wi`, which points away from
    /// it.
    #[must_use]
    pub fn interaction(&self, shape: ShapeId, wi: Vec3) -> SurfaceInteraction {
        let shading = Frame::from_normal(self.shading_normal);
        SurfaceInteraction {
            point: self.point,
            wi: shading.to_local(wi),
            shape,
            ..SurfaceInteraction::at_uv(self.uv, shading)
        }
    }

    /// The unit geometric normal on the emitting side, which is that of the shading normal.
    #[must_use]
    pub fn front(&self) -> Vec3 {
        self.normal * 1.0_f32.copysign(self.normal.dot(self.shading_normal))
    }

    /// Takes the value apart and rebuilds it, so that it stays in registers. Otherwise the compiler
    /// stores it to memory piece by piece, to merge it with the in-memory result of a call, and
    /// reads it back in larger pieces. That defeats store forwarding and cost 3 % of a render.
    #[inline(always)]
    pub(crate) fn in_registers(self) -> Self {
        let Self { point, error, normal, shading_normal, uv, pdf } = self;
        Self { point, error, normal, shading_normal, uv, pdf }
    }

    /// Converts the density from per area to per solid angle seen from `reference`; `None` if the
    /// surface is edge-on or the points coincide.
    #[inline(always)]
    #[must_use]
    pub fn seen_from(self, reference: Vec3) -> Option<Self> {
        let pdf = area_to_solid_angle(self.pdf, self.point - reference, self.normal)?;
        Some(Self { pdf, ..self })
    }
}

/// Converts a density per area to one per solid angle. `path` leads from the reference point to a
/// surface with the unit `normal`. Returns `None` if the result is not finite.
#[inline(always)]
#[must_use]
pub fn area_to_solid_angle(pdf: f32, path: Vec3, normal: Vec3) -> Option<f32> {
    let (pdf, exists) = area_to_solid_angle_lanes(pdf, path.into(), normal.into());
    exists.then_some(pdf)
}

/// Like [`area_to_solid_angle`], for any [`Real`]; the mask tells where the density is finite.
#[inline(always)]
#[must_use]
pub fn area_to_solid_angle_lanes<R: Real>(
    pdf: R,
    path: Vector3<R>,
    normal: Vector3<R>,
) -> (R, R::Mask) {
    let distance_squared = path.length_squared();
    // |cos θ| · distance = |path · normal|.
    let pdf = pdf * distance_squared * distance_squared.sqrt() / path.dot(normal).abs();
    (pdf, pdf.is_finite() & pdf.above(0.0))
}

impl SurfacePoint {
    /// See [`ShapeSample::in_registers`].
    #[inline(always)]
    pub(crate) fn in_registers(self) -> Self {
        let Self { point, error, normal, shading_normal, uv, dp_du, dp_dv } = self;
        Self { point, error, normal, shading_normal, uv, dp_du, dp_dv }
    }
}
