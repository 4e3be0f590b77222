//! `linearcurve`: straight tubes with round joints.

use super::{ShapeModel, SurfacePoint};
use crate::builder::Assets;
use crate::inputs::curve_file::{self, Curves};
use crate::manual::{Manual, parameter};
use etendue_bvh::{Hit, PrimitiveHit};
use etendue_document::Parameters;
use etendue_math::{
    Bounds3, Ray, coordinate_system, polynomial::quadratic_roots, rounding_error_bound,
};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::TAU;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Chains of straight round tubes whose radius changes linearly, with spheres at joints and \
              ends. A file has one control point a line, `x y z radius`, and an empty line between \
              chains. Rays from within do not see the surface. The coordinate u runs around, v along \
              all segments of the file.",
    parameters: &[
        parameter("filename", "string", "", "The file."),
        parameter("radius", "float", "", "The radius where the file gives `x y z` only."),
        parameter("to_world", "transform", "", "Placement of the control points; radii stay."),
    ],
    sample: r#"<shape type="linearcurve"><string name="filename" value="curves.txt"/></shape>"#,
};

/// Tubes in world space.
#[derive(Clone, Debug)]
pub struct LinearCurve {
    curves: Curves,
}

/// Reads tubes.
#[must_use]
pub fn build(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<LinearCurve> {
    curve_file::read(assets, parameters, 2).map(|curves| LinearCurve { curves })
}

/// A segment: the spheres with radius `radius` + s·`growth` around `start` + s·`axis`, where
/// 0 ≤ s ≤ 1.
struct Segment {
    start: DVec3,
    axis: DVec3,
    radius: f64,
    growth: f64,
    /// The squared axis length minus the squared growth. Not positive if one end sphere contains
    /// the other, so that there is no mantle between them.
    mantle: f64,
}

impl Segment {
    /// The parameter of the sphere that touches the mantle nearest to `offset` from the start.
    fn share(&self, offset: DVec3) -> f64 {
        (offset.dot(self.axis) + self.radius * self.growth) / self.mantle
    }

    /// Like [`Self::share`], for any point of the surface.
    fn clamped_share(&self, offset: DVec3) -> f64 {
        if self.mantle > 0.0 {
            self.share(offset).clamp(0.0, 1.0)
        } else if self.growth > 0.0 {
            1.0
        } else {
            0.0
        }
    }

    fn sphere(&self, s: f64) -> (DVec3, f64) {
        (self.axis * s, self.radius + self.growth * s)
    }

    /// Where the line `offset` + t·`direction` enters the surface.
    ///
    /// The squared distance to the sphere s is least at [`Self::share`]. Substituting it gives a
    /// quadratic for the mantle. The whole surface lies within the double cone that the quadratic
    /// describes. As the surface is a convex hull, a line enters it only once.
    fn enter(&self, offset: DVec3, direction: DVec3) -> Option<f64> {
        let ball = |s: f64| {
            let (center, radius) = self.sphere(s);
            let from_center = offset - center;
            let b = 2.0 * from_center.dot(direction);
            let c = from_center.length_squared() - radius * radius;
            quadratic_roots(direction.length_squared(), b, c).map(|(low, _)| low)
        };
        if self.mantle <= 0.0 {
            return ball(self.clamped_share(offset));
        }
        let (along, per_t) =
            (offset.dot(self.axis) + self.radius * self.growth, direction.dot(self.axis));
        let a = direction.length_squared() - per_t * per_t / self.mantle;
        let b = 2.0 * (offset.dot(direction) - along * per_t / self.mantle);
        let c = offset.length_squared() - self.radius * self.radius - along * along / self.mantle;
        let share = |t: f64| self.share(offset + direction * t);
        let mantle = quadratic_roots(a, b, c).map_or([f64::NAN; 2], |(low, high)| [low, high]);
        let is_entry = |t: f64| {
            let s = share(t);
            let at = offset + direction * t - self.sphere(s).0;
            (0.0..=1.0).contains(&s) && at.dot(direction) <= 0.0
        };
        let on_mantle = mantle.into_iter().filter(|t| is_entry(*t));
        let at_start = ball(0.0).filter(|t| share(*t) <= 0.0);
        let at_end = ball(1.0).filter(|t| share(*t) >= 1.0);
        on_mantle.chain(at_start).chain(at_end).min_by(f64::total_cmp)
    }
}

impl ShapeModel for LinearCurve {
    fn bounds(&self) -> Bounds3 {
        super::union(self.boxes())
    }

    fn primitive_boxes(&self) -> Vec<Bounds3> {
        self.boxes()
    }

    fn primitive_count(&self) -> usize {
        self.segment_count()
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        let t = self.intersect(primitive, ray)?;
        Some(PrimitiveHit { t, u: 0.0, v: 0.0 })
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.surface_point(hit.primitive, ray, hit.t)
    }

    fn memory_bytes(&self) -> usize {
        self.memory_bytes()
    }
}

impl LinearCurve {
    fn segment(&self, segment: u32) -> Segment {
        let [a, b] = [0, 1].map(|index| self.curves.point(segment, index).as_dvec4());
        let axis = b.truncate() - a.truncate();
        let growth = b.w - a.w;
        let mantle = axis.length_squared() - growth * growth;
        Segment { start: a.truncate(), axis, radius: a.w, growth, mantle }
    }

    /// The distance at which the ray enters a segment from outside.
    #[must_use]
    pub fn intersect(&self, segment: u32, ray: &Ray) -> Option<f32> {
        let segment = self.segment(segment);
        let direction = ray.direction.as_dvec3();
        let from_start = ray.origin.as_dvec3() - segment.start;
        // Start from the ray's point nearest to the segment, to keep precision for distant ray
        // origins.
        let shift = -from_start.dot(direction) / direction.length_squared();
        let t = segment.enter(from_start + direction * shift, direction)? + shift;
        let t = t as f32;
        (t > 0.0 && t < ray.t_max).then_some(t)
    }

    /// The surface point where `ray` enters a segment at distance `t`.
    #[inline(never)]
    #[must_use]
    pub fn surface_point(&self, index: u32, ray: &Ray, t: f32) -> SurfacePoint {
        let segment = self.segment(index);
        let place = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t);
        let offset = place - segment.start;
        let s = segment.clamped_share(offset);
        let (center, radius) = segment.sphere(s);
        let outwards = (offset - center).normalize_or(-ray.direction.as_dvec3().normalize());
        let point = (segment.start + center + outwards * radius).as_vec3();
        let normal = outwards.as_vec3().normalize();
        let axis = segment.axis.normalize_or(DVec3::Z).as_vec3();
        let count = self.curves.starts.len() as f32;
        let around = axis.cross(normal) * (radius as f32 * TAU);
        let along = (segment.axis + outwards * segment.growth).as_vec3() * count;
        let has_tangents = around.length_squared() > 0.0 && along.length_squared() > 0.0;
        let (dp_du, dp_dv) = if has_tangents { (around, along) } else { coordinate_system(normal) };
        SurfacePoint {
            point,
            error: point.abs() * rounding_error_bound(2) + Vec3::splat(radius as f32 * 1e-7),
            normal,
            shading_normal: normal,
            uv: Vec2::new(
                curve_file::azimuth(axis, normal),
                ((f64::from(index) + s) / f64::from(count)) as f32,
            ),
            dp_du,
            dp_dv,
        }
    }

    /// The bounding box of each segment.
    #[must_use]
    pub fn boxes(&self) -> Vec<Bounds3> {
        let ball = |point: glam::Vec4| {
            let (center, reach) = (point.truncate(), Vec3::splat(point.w));
            Bounds3::new((center - reach).map(f32::next_down), (center + reach).map(f32::next_up))
        };
        (0..self.curves.starts.len() as u32)
            .map(|segment| {
                ball(self.curves.point(segment, 0)).union(ball(self.curves.point(segment, 1)))
            })
            .collect()
    }

    /// The number of segments.
    #[must_use]
    pub fn segment_count(&self) -> usize {
        self.curves.starts.len()
    }

    /// Memory use in bytes.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.curves.memory_bytes()
    }
}
