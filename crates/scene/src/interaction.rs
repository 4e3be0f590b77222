//! What is known where a ray has met a surface.

use crate::ids::{InstanceId, ShapeId};
use etendue_math::lanes::{Real, Vector3};
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
    /// Surface coordinates alone, for textures that are evaluated without a surface.
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

/// Where on a surface a ray arrives, before the frame and coordinates that the caller may not need.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// The point.
    pub point: Vec3,
    /// A bound of the absolute error of each coordinate of `point`.
    pub error: Vec3,
    /// The unit geometric normal.
    pub normal: Vec3,
    /// The shading normal: unit, or the geometric one.
    pub shading_normal: Vec3,
    /// Surface coordinates.
    pub uv: Vec2,
    /// ∂point/∂u.
    pub dp_du: Vec3,
    /// ∂point/∂v.
    pub dp_dv: Vec3,
}

/// A point sampled on a shape, for light.
#[derive(Clone, Copy, Debug)]
pub struct ShapeSample {
    /// The point.
    pub point: Vec3,
    /// A bound of the absolute error of each coordinate of `point`.
    pub error: Vec3,
    /// The unit geometric normal.
    pub normal: Vec3,
    /// The shading normal, which decides which side sends out light.
    pub shading_normal: Vec3,
    /// Surface coordinates.
    pub uv: Vec2,
    /// The density: by area from [`Shape::sample_area`](crate::shape::Shape::sample_area), in solid angle from [`Shape::sample_direction`](crate::shape::Shape::sample_direction).
    pub pdf: f32,
}

impl ShapeSample {
    /// What textures ask about the point, seen along `wi`, which points away from it.
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

    /// The unit geometric normal on the side where the shading normal points, which sends out light.
    #[must_use]
    pub fn front(&self) -> Vec3 {
        self.normal * 1.0_f32.copysign(self.normal.dot(self.shading_normal))
    }

    /// The same, taken apart and put together again. What a call returns lies in memory; where it meets
    /// a value computed in place, the compiler would put that there too, piece by piece, and read it
    /// back in larger pieces, which the processor cannot forward: 3 % of a render.
    #[inline(always)]
    pub(crate) fn in_registers(self) -> Self {
        let Self { point, error, normal, shading_normal, uv, pdf } = self;
        Self { point, error, normal, shading_normal, uv, pdf }
    }

    /// The same point with its density per area turned into one per solid angle seen from
    /// `reference`; `None` where the surface is seen edge-on or the points coincide.
    #[inline(always)]
    #[must_use]
    pub fn seen_from(self, reference: Vec3) -> Option<Self> {
        let pdf = area_to_solid_angle(self.pdf, self.point - reference, self.normal)?;
        Some(Self { pdf, ..self })
    }
}

/// Turns a density per area at the end of `path`, on a surface with the unit `normal`, into one per
/// solid angle at its start; `None` where it is not finite.
#[inline(always)]
#[must_use]
pub fn area_to_solid_angle(pdf: f32, path: Vec3, normal: Vec3) -> Option<f32> {
    let (pdf, exists) = area_to_solid_angle_lanes(pdf, path.into(), normal.into());
    exists.then_some(pdf)
}

/// As [`area_to_solid_angle`], over any [`Real`]; the mask says where the density is finite.
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
    /// As [`ShapeSample::in_registers`].
    #[inline(always)]
    pub(crate) fn in_registers(self) -> Self {
        let Self { point, error, normal, shading_normal, uv, dp_du, dp_dv } = self;
        Self { point, error, normal, shading_normal, uv, dp_du, dp_dv }
    }
}
