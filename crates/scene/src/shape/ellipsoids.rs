//! `ellipsoids`: many ellipsoids, intersected in double precision.

use super::{ShapeModel, SurfacePoint};
use crate::builder::Assets;
use crate::inputs::ellipsoid_file::{self, Ellipsoid};
use crate::manual::Manual;
use etendue_bvh::{Hit, PrimitiveHit};
use etendue_document::Parameters;
use etendue_math::polynomial::quadratic_roots;
use etendue_math::{Bounds3, Ray, coordinate_system, rounding_error_bound};
use glam::{DVec3, Vec2};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A cloud of ellipsoids, such as Gaussian splats, as surfaces. Rays from within do not see \
              an ellipsoid's surface, so that overlapping ones are one body. There are no surface \
              coordinates, and no light is sampled on it. What else the file holds, such as colours, is \
              for volumetric integrators that are not here.",
    parameters: &[
        ellipsoid_file::FILENAME,
        ellipsoid_file::SCALE_FACTOR,
        ellipsoid_file::EXTENT,
        ellipsoid_file::EXTENT_ADAPTIVE_CLAMPING,
        ellipsoid_file::TO_WORLD,
    ],
    sample: r#"<shape type="ellipsoids">
    <string name="filename" value="ellipsoids.ply"/>
    <float name="extent" value="1"/>
</shape>"#,
};

/// Ellipsoids in world space.
#[derive(Clone, Debug)]
pub struct Ellipsoids {
    ellipsoids: Vec<Ellipsoid>,
}

/// Reads ellipsoids.
#[must_use]
pub fn build(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Ellipsoids> {
    ellipsoid_file::read(assets, parameters).map(|ellipsoids| Ellipsoids { ellipsoids })
}

impl ShapeModel for Ellipsoids {
    fn bounds(&self) -> Bounds3 {
        super::union(self.boxes())
    }

    fn primitive_boxes(&self) -> Vec<Bounds3> {
        self.boxes()
    }

    fn primitive_count(&self) -> usize {
        self.count()
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        let t = self.intersect(primitive, ray)?;
        Some(PrimitiveHit { t, u: 0.0, v: 0.0 })
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.surface_point(hit.primitive, ray)
    }

    fn memory_bytes(&self) -> usize {
        self.memory_bytes()
    }
}

impl Ellipsoids {
    /// The distance at which the ray enters an ellipsoid, and the point in the space where the
    /// ellipsoid is the unit sphere.
    fn enter(&self, index: u32, ray: &Ray) -> Option<(f64, DVec3)> {
        let ellipsoid = &self.ellipsoids[index as usize];
        let to_local = ellipsoid.axes().transpose();
        let scale = ellipsoid.half_axes.as_dvec3().recip();
        let origin = to_local * (ray.origin.as_dvec3() - ellipsoid.center.as_dvec3()) * scale;
        let direction = to_local * ray.direction.as_dvec3() * scale;
        // Expanding around the point nearest to the centre keeps the discriminant accurate if the
        // origin is many radii away, as in `sphere`.
        let a = direction.length_squared();
        let nearest = -origin.dot(direction) / a;
        let miss = origin + direction * nearest;
        let (low, _) = quadratic_roots(a, 0.0, miss.length_squared() - 1.0)?;
        Some((nearest + low, miss + direction * low))
    }

    /// The distance at which the ray enters an ellipsoid from outside.
    #[must_use]
    pub fn intersect(&self, index: u32, ray: &Ray) -> Option<f32> {
        let t = self.enter(index, ray)?.0 as f32;
        (t > 0.0 && t < ray.t_max).then_some(t)
    }

    /// The surface point where `ray`, which must hit the ellipsoid, enters it.
    #[must_use]
    pub fn surface_point(&self, index: u32, ray: &Ray) -> SurfacePoint {
        let ellipsoid = &self.ellipsoids[index as usize];
        // Intersect again: the stored distance is rounded, which would give another point on a flat
        // ellipsoid.
        let local = self.enter(index, ray).map_or(DVec3::Z, |(_, local)| local.normalize());
        let (axes, half_axes) = (ellipsoid.axes(), ellipsoid.half_axes.as_dvec3());
        let point = ellipsoid.center.as_dvec3() + axes * (local * half_axes);
        let normal = (axes * (local / half_axes)).normalize_or(DVec3::Z).as_vec3().normalize();
        let (dp_du, dp_dv) = coordinate_system(normal);
        let point = point.as_vec3();
        let reach = ellipsoid.half_axes.max_element();
        SurfacePoint {
            point,
            // Everything but the last rounding is in double precision.
            error: point.abs() * rounding_error_bound(2) + reach * 1e-9,
            normal,
            shading_normal: normal,
            uv: Vec2::ZERO,
            dp_du,
            dp_dv,
        }
    }

    /// The bounding box of each ellipsoid.
    #[must_use]
    pub fn boxes(&self) -> Vec<Bounds3> {
        self.ellipsoids.iter().map(Ellipsoid::bounds).collect()
    }

    /// The number of ellipsoids.
    #[must_use]
    pub fn count(&self) -> usize {
        self.ellipsoids.len()
    }

    /// Memory use in bytes.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.ellipsoids.as_slice())
    }
}
