//! `sphere`: intersected in double precision; sampled within the cone seen from a point.

use super::{ShapeModel, ShapeSample, SurfacePoint};
use crate::builder::Assets;
use crate::inputs::transform::read_transform;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use etendue_bvh::{Hit, PrimitiveHit};
use etendue_document::{Fault, Parameters};
use etendue_math::polynomial::quadratic_roots;
use etendue_math::{Bounds3, Ray, coordinate_system, rounding_error_bound};
use etendue_sampling::warp;
use glam::{DMat3, DVec3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A sphere. Intersections are computed in double precision, so spheres of any size stand \
              side by side.",
    parameters: &[
        parameter("center", "point", "0, 0, 0", "The centre, before `to_world`."),
        parameter("radius", "float", "1", "The radius, before `to_world`."),
        parameter("flip_normals", "boolean", "false", "Let the normals point inwards."),
        parameter(
            "to_world",
            "transform",
            "",
            "Placement; it may scale, but equally along all axes.",
        ),
    ],
    sample: r#"<shape type="sphere"><point name="center" x="0" y="1" z="0"/><float name="radius" value="0.5"/></shape>"#,
};

/// A sphere in world space.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
    /// World directions to the sphere's local axes, for its coordinates; a rotation or a
    /// reflection.
    to_local: DMat3,
    flip_normals: bool,
}

/// Reads a sphere.
#[must_use]
pub fn build(_assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Sphere> {
    let center = parameters.point("center", DVec3::ZERO);
    let radius = parameters.float_in("radius", 1.0, f64::MIN_POSITIVE..=f64::from(f32::MAX));
    let flip_normals = parameters.boolean("flip_normals", false);
    let matrix = parameters.transform("to_world");
    read_transform(parameters, "to_world")?;
    let linear = DMat3::from_mat4(matrix);
    let scale = linear.x_axis.length();
    let uniform = [linear.y_axis, linear.z_axis]
        .iter()
        .all(|axis| (axis.length() / scale - 1.0).abs() < 1e-3)
        && linear.x_axis.dot(linear.y_axis).abs() < 1e-3 * scale * scale
        && linear.y_axis.dot(linear.z_axis).abs() < 1e-3 * scale * scale
        && linear.z_axis.dot(linear.x_axis).abs() < 1e-3 * scale * scale;
    let to_local = if uniform {
        (linear * (1.0 / scale)).transpose()
    } else {
        let message = "a sphere stays round: it has the size along its x axis";
        parameters.warning(Fault::Approximation, "to_world", message);
        let x = linear.x_axis / scale;
        let y = (linear.y_axis - x * x.dot(linear.y_axis)).try_normalize();
        let y = y.unwrap_or_else(|| x.any_orthonormal_vector());
        let z = x.cross(y) * 1.0_f64.copysign(linear.determinant());
        DMat3::from_cols(x, y, z).transpose()
    };
    Some(Sphere {
        center: matrix.transform_point3(center),
        radius: radius * scale,
        to_local,
        flip_normals,
    })
}

impl ShapeModel for Sphere {
    fn bounds(&self) -> Bounds3 {
        self.bounds()
    }

    fn intersect(&self, _primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        let t = self.intersect(ray)?;
        Some(PrimitiveHit { t, u: 0.0, v: 0.0 })
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.surface_point(ray, hit.t)
    }

    fn area(&self) -> f32 {
        self.area()
    }

    fn sample_area(&self, random: Vec2) -> Option<ShapeSample> {
        Some(self.sample_area(random))
    }

    fn sample_direction(&self, reference: Vec3, random: Vec2) -> Option<ShapeSample> {
        self.sample_direction(reference, random)
    }

    fn pdf_direction(&self, reference: Vec3, surface: &SurfaceInteraction) -> f32 {
        self.pdf_direction(reference, surface.point, surface.normal)
    }
}

impl Sphere {
    /// The distance at which the ray first hits the surface.
    #[inline]
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> Option<f32> {
        let (origin, direction) = (ray.origin.as_dvec3() - self.center, ray.direction.as_dvec3());
        // Expanding around the point of the ray nearest to the centre keeps the discriminant
        // accurate if the origin is many radii away (Haines et al., Ray Tracing Gems, chapter 7).
        let a = direction.length_squared();
        let nearest = -origin.dot(direction) / a;
        let miss = origin + direction * nearest;
        let (low, high) =
            quadratic_roots(a, 0.0, miss.length_squared() - self.radius * self.radius)?;
        let inside = |t: &f32| *t > 0.0 && *t < ray.t_max;
        [(nearest + low) as f32, (nearest + high) as f32].into_iter().find(inside)
    }

    /// The surface point that the ray hits at distance `t`.
    #[must_use]
    pub fn surface_point(&self, ray: &Ray, t: f32) -> SurfacePoint {
        let hit = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t);
        // t is rounded, so the point lies slightly off the surface. Project it back.
        self.at((hit - self.center).normalize_or(DVec3::Z))
    }

    /// The surface point in the unit direction `outwards` from the centre.
    fn at(&self, outwards: DVec3) -> SurfacePoint {
        let point = (self.center + outwards * self.radius).as_vec3();
        let local = self.to_local * outwards;
        let azimuth = (local.y as f32).atan2(local.x as f32);
        let azimuth = if azimuth < 0.0 { azimuth + TAU } else { azimuth };
        let theta = (local.z.clamp(-1.0, 1.0) as f32).acos();
        let rim = local.x.hypot(local.y);
        let normal = outwards.as_vec3().normalize();
        let from_local = self.to_local.transpose();
        let (dp_du, dp_dv) = if rim > 0.0 {
            let (sin, cos) = (local.y / rim, local.x / rim);
            let du = DVec3::new(-local.y, local.x, 0.0) * std::f64::consts::TAU;
            let dv = DVec3::new(local.z * cos, local.z * sin, -rim) * std::f64::consts::PI;
            ((from_local * du * self.radius).as_vec3(), (from_local * dv * self.radius).as_vec3())
        } else {
            coordinate_system(normal)
        };
        let normal = if self.flip_normals { -normal } else { normal };
        SurfacePoint {
            point,
            // Centre, radius and direction are in double precision. Only the last rounding of each
            // coordinate counts, plus an error of 1e-16 radii from the products.
            error: point.abs() * rounding_error_bound(2)
                + Vec3::splat((self.radius * 1e-15) as f32),
            normal,
            shading_normal: normal,
            uv: Vec2::new(azimuth / TAU, theta / PI),
            dp_du,
            dp_dv,
        }
    }

    /// The bounding box, rounded outwards.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        let grow = |v: DVec3, sign: f64| {
            let exact = v + DVec3::splat(sign * self.radius);
            let rounded = exact.as_vec3();
            Vec3::from_array(
                rounded.to_array().map(|x| if sign < 0.0 { x.next_down() } else { x.next_up() }),
            )
        };
        Bounds3::new(grow(self.center, -1.0), grow(self.center, 1.0))
    }

    /// The surface area.
    #[must_use]
    pub fn area(&self) -> f32 {
        (4.0 * std::f64::consts::PI * self.radius * self.radius) as f32
    }

    fn sample_at(&self, outwards: DVec3, pdf: f32) -> ShapeSample {
        let surface = self.at(outwards);
        ShapeSample {
            point: surface.point,
            error: surface.error,
            normal: surface.normal,
            shading_normal: surface.normal,
            uv: surface.uv,
            pdf,
        }
    }

    /// Samples a point uniform in area.
    #[must_use]
    pub fn sample_area(&self, random: Vec2) -> ShapeSample {
        self.sample_at(warp::uniform_sphere::sample(random).as_dvec3(), 1.0 / self.area())
    }

    /// sin² of half the angle that the sphere subtends at `reference`, in single precision; `None`
    /// from inside.
    fn sin2_half_angle(&self, reference: Vec3) -> Option<f64> {
        let distance_squared = (self.center - reference.as_dvec3()).length_squared();
        let sin2 = self.radius * self.radius / distance_squared;
        // Points on the surface count as inside: the cone would be a half space, and they see the
        // far side.
        (sin2 < 1.0 - 1e-6).then_some(sin2)
    }

    /// Samples a point of the visible cap, uniform in solid angle from `reference`; from inside,
    /// uniform in area.
    #[must_use]
    pub fn sample_direction(&self, reference: Vec3, random: Vec2) -> Option<ShapeSample> {
        let Some(sin2_max) = self.sin2_half_angle(reference) else {
            return self.sample_area(random).seen_from(reference);
        };
        let height = cone_height(sin2_max);
        let to_reference = reference.as_dvec3() - self.center;
        let distance = to_reference.length();
        // cos θ = 1 − u (1 − cos θmax), kept as 1 − cos for accuracy in small cones.
        let one_minus_cos = f64::from(random.x) * height;
        let sin2 = one_minus_cos * (2.0 - one_minus_cos);
        let cos = 1.0 - one_minus_cos;
        // The angle at the centre between the directions to the reference and to the point.
        let along = distance * cos
            - (self.radius * self.radius - distance * distance * sin2).max(0.0).sqrt();
        let sin_center = (along * sin2.sqrt() / self.radius).min(1.0);
        let cos_center = ((distance - along * cos) / self.radius).clamp(-1.0, 1.0);
        let axis = to_reference / distance;
        let (s, t) = coordinate_system(axis.as_vec3());
        let (sin_azimuth, cos_azimuth) = f64::from(TAU * random.y).sin_cos();
        let outwards = s.as_dvec3() * (sin_center * cos_azimuth)
            + t.as_dvec3() * (sin_center * sin_azimuth)
            + axis * cos_center;
        Some(self.sample_at(outwards.normalize(), cone_pdf(height)))
    }

    /// The density in solid angle of [`Self::sample_direction`] for a point of the surface.
    #[must_use]
    pub fn pdf_direction(&self, reference: Vec3, point: Vec3, normal: Vec3) -> f32 {
        match self.sin2_half_angle(reference) {
            Some(sin2_max) => cone_pdf(cone_height(sin2_max)),
            None => super::area_to_solid_angle(1.0 / self.area(), point - reference, normal)
                .unwrap_or(0.0),
        }
    }
}

/// 1 − cos θmax of a cone from sin² θmax, without cancellation.
fn cone_height(sin2_max: f64) -> f64 {
    sin2_max / (1.0 + (1.0 - sin2_max).max(0.0).sqrt())
}

fn cone_pdf(height: f64) -> f32 {
    (1.0 / (std::f64::consts::TAU * height)) as f32
}
