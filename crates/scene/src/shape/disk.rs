//! `disk`: flat and round.

use super::{ShapeModel, ShapeSample, SurfacePoint};
use crate::builder::Assets;
use crate::inputs::transform::read_transform;
use crate::manual::{Manual, parameter};
use crate::models::mesh::parallelogram_area;
use etendue_bvh::{Hit, PrimitiveHit};
use etendue_document::Parameters;
use etendue_math::{Bounds3, Ray, Transform, rounding_error_bound};
use etendue_sampling::warp;
use glam::{DAffine3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A disk of radius 1 around the origin in the plane z = 0, facing +z, placed by `to_world`.",
    parameters: &[
        parameter("flip_normals", "boolean", "false", "Let the normal point the other way."),
        parameter("to_world", "transform", "", "Placement."),
    ],
    sample: r#"<shape type="disk"><transform name="to_world"><scale value="2"/></transform></shape>"#,
};

/// A disk in world space; an ellipse if `to_world` scales non-uniformly.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    to_world: Transform,
    /// World to local space, in double precision so that rounding does not make rays that leave the
    /// disk hit it again.
    to_local: DAffine3,
    normal: Vec3,
    area: f32,
}

/// Reads a disk.
#[must_use]
pub fn build(_assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Disk> {
    let flip_normals = parameters.boolean("flip_normals", false);
    let to_world = read_transform(parameters, "to_world")?;
    let to_local = DAffine3::from_mat4(parameters.transform("to_world")).inverse();
    Some(Disk::new(to_world, to_local, flip_normals))
}

impl ShapeModel for Disk {
    fn bounds(&self) -> Bounds3 {
        self.bounds()
    }

    fn intersect(&self, _primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        let (t, local) = self.intersect(ray)?;
        Some(PrimitiveHit { t, u: local.x, v: local.y })
    }

    fn surface_point(&self, _ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.surface_point(Vec2::new(hit.u, hit.v))
    }

    fn area(&self) -> f32 {
        self.area()
    }

    fn sample_area(&self, random: Vec2) -> Option<ShapeSample> {
        Some(self.sample_area(random))
    }
}

impl Disk {
    fn new(to_world: Transform, to_local: DAffine3, flip_normals: bool) -> Self {
        let square = parallelogram_area(to_world.vector(Vec3::X), to_world.vector(Vec3::Y));
        let normal = to_world.normal(Vec3::Z).normalize_or(Vec3::Z);
        let normal = if flip_normals { -normal } else { normal };
        Self { to_world, to_local, normal, area: PI * square }
    }

    /// The distance at which the ray hits the disk, and the local x and y there.
    #[inline]
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> Option<(f32, Vec2)> {
        let origin = self.to_local.transform_point3(ray.origin.as_dvec3());
        let direction = self.to_local.transform_vector3(ray.direction.as_dvec3());
        let t = -origin.z / direction.z;
        let local = (origin + direction * t).truncate();
        // A ray within the plane gives NaN, which fails the comparisons.
        let inside = t > 0.0 && t < f64::from(ray.t_max) && local.length_squared() <= 1.0;
        inside.then(|| (t as f32, local.as_vec2()))
    }

    /// The surface point at the `local` x and y.
    #[must_use]
    pub fn surface_point(&self, local: Vec2) -> SurfacePoint {
        let matrix = self.to_world.affine();
        let terms = [
            Vec3::from(matrix.matrix3.x_axis) * local.x,
            Vec3::from(matrix.matrix3.y_axis) * local.y,
            Vec3::from(matrix.translation),
        ];
        let radius = local.length();
        let azimuth = local.y.atan2(local.x);
        let azimuth = if azimuth < 0.0 { azimuth + TAU } else { azimuth };
        let radial = if radius > 0.0 { local / radius } else { Vec2::X };
        SurfacePoint {
            point: terms[0] + terms[1] + terms[2],
            error: terms.iter().map(|term| term.abs()).sum::<Vec3>() * rounding_error_bound(7),
            normal: self.normal,
            shading_normal: self.normal,
            uv: Vec2::new(radius, azimuth / TAU),
            dp_du: self.to_world.vector(radial.extend(0.0)),
            dp_dv: self.to_world.vector(radial.perp().extend(0.0)) * (TAU * radius),
        }
    }

    /// The bounding box.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        let square = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
        Bounds3::from_points(square.map(|(x, y)| self.to_world.point(Vec3::new(x, y, 0.0))))
    }

    /// The area of one side.
    #[must_use]
    pub fn area(&self) -> f32 {
        self.area
    }

    /// Samples a point uniform in area.
    #[must_use]
    pub fn sample_area(&self, random: Vec2) -> ShapeSample {
        let surface = self.surface_point(warp::concentric_disk::sample(random));
        ShapeSample {
            point: surface.point,
            error: surface.error,
            normal: surface.normal,
            shading_normal: surface.normal,
            uv: surface.uv,
            pdf: 1.0 / self.area,
        }
    }
}
