//! `revsurface`: a profile rotated about the y axis, intersected exactly.
//!
//! Rotated about the axis into one half plane, a ray becomes a hyperbola ([`line`]). Eliminating t
//! and the azimuth leaves a polynomial of degree six in the parameter of a cubic profile segment,
//! which vanishes where the ray crosses it. Segments are cut into short pieces (`piece`) under a
//! separate tree (`tree`). All roots on a piece are isolated by the signs of its Bernstein
//! coefficients and refined (`roots`).
//!
//! All computations use double precision, in a space where the profile has size one.

mod area;
mod line;
mod piece;
mod roots;
#[cfg(test)]
mod tests;
mod tree;

use super::{ShapeModel, ShapeSample, SurfacePoint};
use crate::builder::Assets;
use crate::inputs::transform::read_transform;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::models::profile::{self, Segment};
use area::AreaTable;
use etendue_bvh::{Hit, PrimitiveHit};
use etendue_document::{Class, Fault, Parameters};
use etendue_math::{Bounds3, Ray, coordinate_system, rounding_error_bound};
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec2, Vec3};
use line::Line;
use piece::{Piece, Root};
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use tree::Tree;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A surface of revolution: a profile in the (x, y) plane turned about the y axis. The profile \
              is a nested `<curve type=\"Bspline\">` (uniform, cubic) or `<curve type=\"bezier\">` (3n + 1 \
              points) of `<vec>`s, whose z is ignored; x may have either sign. Seen along the profile, the \
              front is on the left.",
    parameters: &[
        parameter("curve", "curve", "", "The profile."),
        parameter("flip_normals", "boolean", "false", "Turn front and back around."),
        parameter("to_world", "transform", "", "Placement."),
    ],
    sample: r#"<shape type="revsurface"><curve type="bezier"><vec value="1, 0, 0"/><vec value="0.5, 0.5, 0"/><vec value="0.5, 1, 0"/><vec value="1, 2, 0"/></curve></shape>"#,
};

/// The maximum number of control points; far more than any real profile needs.
const MAX_SEGMENTS: usize = 10_000;

/// A surface of revolution in world space.
#[derive(Clone, Debug)]
pub struct RevSurface {
    to_local: DAffine3,
    to_world: DAffine3,
    /// Transforms normals to world space, facing the front side.
    normal_to_world: DMat3,
    pieces: Vec<Piece>,
    tree: Tree,
    segment_count: usize,
    /// The squared distance of the farthest point from the local origin.
    radius_squared: f64,
    bounds: Bounds3,
    /// The largest world coordinate.
    extent: f64,
    area: f32,
    sampling: Option<AreaTable>,
}

/// A crossing of a line with the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The ray's parameter, which may be negative.
    pub t: f64,
    /// The coordinate along the profile.
    pub v: f64,
}

/// Reads a surface of revolution.
#[must_use]
pub fn build(_assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<RevSurface> {
    let flip_normals = parameters.boolean("flip_normals", false);
    let segments = read_profile(parameters);
    read_transform(parameters, "to_world")?;
    let to_world = DAffine3::from_mat4(parameters.transform("to_world"));
    let surface = RevSurface::new(&segments?, to_world, flip_normals);
    if surface.is_none() {
        let message = "the profile lies on the axis: there is nothing to be seen";
        parameters.error(Fault::Geometry, "curve", message);
    }
    surface
}

fn read_profile(parameters: &Parameters<'_>) -> Option<Vec<Segment>> {
    let Some(curve) = parameters.unnamed_child(Class::Curve) else {
        parameters.error(
            Fault::MissingParameter,
            "curve",
            "a surface of revolution needs a `<curve>`",
        );
        return None;
    };
    let curve = parameters.document().parameters(curve.node, parameters.diagnostics());
    let points: Vec<DVec2> = curve.points("points").iter().map(|p| p.truncate()).collect();
    let segments = match curve.plugin().to_ascii_lowercase().as_str() {
        "bspline" => Some(profile::from_b_spline(&points)).filter(|segments| !segments.is_empty()),
        "bezier" => profile::from_bezier(&points),
        other => {
            let message = format!("unknown curve type `{other}`: there are `Bspline` and `bezier`");
            curve.error(Fault::UnknownPlugin, "points", message);
            return None;
        }
    };
    let finite = points.iter().all(|p| p.is_finite() && p.abs().max_element() < 1e18);
    let usable = segments.filter(|segments| segments.len() <= MAX_SEGMENTS && finite);
    if usable.is_none() {
        let message = format!(
            "{} finite points do not make a profile: a B-spline takes 4 or more, a Bézier chain 3n + 1",
            points.len()
        );
        curve.error(Fault::BadValue, "points", message);
    }
    curve.finish();
    usable
}

impl ShapeModel for RevSurface {
    fn bounds(&self) -> Bounds3 {
        self.bounds()
    }

    fn intersect(&self, _primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        let (t, local) = self.intersect(ray)?;
        Some(PrimitiveHit { t, u: local.x, v: local.y })
    }

    fn occludes(&self, _primitive: u32, ray: &Ray) -> bool {
        self.occludes(ray)
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.surface_point(ray, hit.t, Vec2::new(hit.u, hit.v))
    }

    const PREPARES_SAMPLING: bool = true;

    fn prepare_sampling(&mut self) {
        self.prepare_sampling();
    }

    fn area(&self) -> f32 {
        self.area()
    }

    fn sample_area(&self, random: Vec2) -> Option<ShapeSample> {
        self.sample_area(random)
    }

    fn pdf_area(&self, surface: &SurfaceInteraction) -> f32 {
        self.pdf_area(surface.uv.y, surface.dp_du, surface.dp_dv)
    }

    fn memory_bytes(&self) -> usize {
        self.memory_bytes()
    }
}

impl RevSurface {
    /// Rotates `segments` about the y axis. Returns `None` if all of them lie on the axis, or if
    /// the transform is singular. The front is on the left of the profile, unless `flip_normals`.
    #[must_use]
    pub fn new(segments: &[Segment], to_world: DAffine3, flip_normals: bool) -> Option<Self> {
        let points = || segments.iter().flatten();
        let low = points().fold(f64::INFINITY, |low, p| low.min(p.y));
        let high = points().fold(f64::NEG_INFINITY, |high, p| high.max(p.y));
        let width = points().fold(0.0, |width: f64, p| width.max(p.x.abs()));
        let middle = DVec2::new(0.0, 0.5 * (low + high));
        let size = width.max(0.5 * (high - low));
        let unit: Vec<Segment> =
            segments.iter().map(|segment| segment.map(|p| (p - middle) / size)).collect();
        let scale = DAffine3::from_scale_rotation_translation(
            DVec3::splat(size),
            glam::DQuat::IDENTITY,
            middle.extend(0.0),
        );
        let to_world = to_world * scale;
        let to_local = to_world.inverse();
        let is_solid = size > 0.0 && size.is_finite();
        let pieces = if is_solid { piece::split(&unit) } else { Vec::new() };
        if pieces.is_empty() || !to_local.is_finite() {
            return None;
        }
        let farthest = |p: &DVec2| p.length_squared();
        let bounds = bounds(&to_world, unit.iter().flatten());
        let mut surface = Self {
            to_local,
            to_world,
            normal_to_world: to_local.matrix3.transpose() * if flip_normals { -1.0 } else { 1.0 },
            tree: Tree::new(&pieces.iter().map(Piece::extent).collect::<Vec<_>>()),
            pieces,
            segment_count: segments.len(),
            // Enlarged slightly to allow for rounding.
            radius_squared: unit.iter().flatten().map(farthest).fold(0.0, f64::max) * (1.0 + 1e-9),
            bounds,
            extent: f64::from(bounds.min.abs().max(bounds.max.abs()).max_element()),
            area: 0.0,
            sampling: None,
        };
        surface.area = area::measure(&surface).1;
        Some(surface)
    }

    /// Prepares the surface for sampling as a light.
    pub fn prepare_sampling(&mut self) {
        self.sampling = area::measure(self).0;
    }

    /// The distance at which the ray first hits the surface, and the place there for
    /// [`Self::surface_point`].
    #[inline]
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> Option<(f32, Vec2)> {
        let line = Line::new(&self.to_local, ray, self.radius_squared)?;
        let mut nearest = None;
        let mut t_max = ray.t_max;
        let _: ControlFlow<()> =
            self.tree.each_piece(&line, self.range(&line, ray), |piece, far| {
                self.pieces[piece].each_crossing(&line, &mut |root| {
                    let t = line.ray_parameter(root.t) as f32;
                    if t > 0.0 && t < t_max {
                        t_max = t;
                        *far = root.t;
                        nearest = Some((t, Vec2::new(root.s as f32, piece as f32)));
                    }
                });
                ControlFlow::Continue(())
            });
        nearest
    }

    /// Whether the ray hits the surface.
    #[inline]
    #[must_use]
    pub fn occludes(&self, ray: &Ray) -> bool {
        let Some(line) = Line::new(&self.to_local, ray, self.radius_squared) else { return false };
        self.tree
            .each_piece(&line, self.range(&line, ray), |piece, _| {
                let mut is_met = false;
                self.pieces[piece].each_crossing(&line, &mut |root| {
                    let t = line.ray_parameter(root.t) as f32;
                    is_met |= t > 0.0 && t < ray.t_max;
                });
                if is_met { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
            .is_break()
    }

    /// Where the line of the ray crosses the surface, also behind the origin, in order of t.
    /// Tangential contacts do not count as crossings.
    #[must_use]
    pub fn crossings(&self, ray: &Ray) -> Vec<Crossing> {
        let mut crossings = Vec::new();
        if let Some(line) = Line::new(&self.to_local, ray, self.radius_squared) {
            let reach = self.reach(&line);
            let _: ControlFlow<()> = self.tree.each_piece(&line, [-reach, reach], |piece, _| {
                self.pieces[piece].each_crossing(&line, &mut |Root { s, t }| {
                    let t = line.ray_parameter(t);
                    crossings.push(Crossing { t, v: self.v(piece, s) });
                });
                ControlFlow::Continue(())
            });
        }
        crossings.sort_by(|a, b| a.t.total_cmp(&b.t));
        crossings
    }

    /// Half the length of the line within the surface's bounding sphere.
    fn reach(&self, line: &Line) -> f64 {
        (self.radius_squared - line.origin.length_squared()).max(0.0).sqrt()
    }

    /// The part of the line that the ray covers.
    #[inline]
    fn range(&self, line: &Line, ray: &Ray) -> [f64; 2] {
        let reach = self.reach(line);
        let end = line.local_parameter(f64::from(ray.t_max));
        [line.start.max(-reach), end.min(reach)]
    }

    /// The surface point that `ray` hits at distance `t`, at the place that [`Self::intersect`]
    /// returned.
    #[inline(never)]
    #[must_use]
    pub fn surface_point(&self, ray: &Ray, t: f32, place: Vec2) -> SurfacePoint {
        let (piece, s) = (place.y as usize, f64::from(place.x));
        let point = profile::point(&self.pieces[piece].control(), s);
        let t = f64::from(t);
        let at = match Line::new(&self.to_local, ray, f64::INFINITY) {
            Some(line) => {
                // Restores the digits of t lost to single precision. For grazing rays, the
                // recomputed value may be less accurate, so clamp it.
                let slack = t * f64::from(f32::EPSILON);
                let refined = line.ray_parameter(line.parameter(point.x, point.y));
                line.at(line.local_parameter(refined.clamp(t - slack, t + slack)))
            }
            None => DVec3::X,
        };
        let side = if point.x < 0.0 { -1.0 } else { 1.0 };
        self.at(piece, s, (at.z * side).atan2(at.x * side))
    }

    /// The surface point at a parameter of a piece and an azimuth.
    fn at(&self, piece: usize, s: f64, azimuth: f64) -> SurfacePoint {
        let control = self.pieces[piece].control();
        let (place, tangent) = (profile::point(&control, s), profile::tangent(&control, s));
        let (sin, cos) = azimuth.sin_cos();
        let turned = |p: DVec2| DVec3::new(p.x * cos, p.y, p.x * sin);
        let point = self.to_world.transform_point3(turned(place)).as_vec3();
        let on_axis = place.x == 0.0;
        // The normal to the left of the profile; on the axis, the axis itself.
        let left = if on_axis {
            DVec3::Y.copysign(DVec3::splat(tangent.x))
        } else {
            turned(DVec2::new(-tangent.y, tangent.x))
        };
        let normal = (self.normal_to_world * left).normalize_or(DVec3::Y).as_vec3().normalize();
        let (dp_du, dp_dv) = if on_axis {
            coordinate_system(normal)
        } else {
            let [around, along] = self.tangents(piece, s, azimuth);
            (around.as_vec3(), along.as_vec3())
        };
        let turns = azimuth / TAU;
        let u = if turns < 0.0 { turns + 1.0 } else { turns };
        SurfacePoint {
            point,
            // The position is computed in double precision; only its last rounding counts.
            error: point.abs() * rounding_error_bound(2)
                + Vec3::splat((self.extent * 1e-12) as f32),
            normal,
            shading_normal: normal,
            uv: Vec2::new(u as f32, self.v(piece, s) as f32),
            dp_du,
            dp_dv,
        }
    }

    /// The derivatives of the point by u and v.
    fn tangents(&self, piece: usize, s: f64, azimuth: f64) -> [DVec3; 2] {
        let control = self.pieces[piece].control();
        let [start, end] = self.pieces[piece].range;
        let per_v = self.segment_count as f64 / (end - start);
        let (x, along) = (profile::point(&control, s).x, profile::derivative(&control, s) * per_v);
        let (sin, cos) = azimuth.sin_cos();
        let around = DVec3::new(-x * sin, 0.0, x * cos) * TAU;
        [around, DVec3::new(along.x * cos, along.y, along.x * sin)]
            .map(|v| self.to_world.transform_vector3(v))
    }

    /// The area element per u and v.
    fn jacobian(&self, piece: usize, s: f64, azimuth: f64) -> f32 {
        let [around, along] = self.tangents(piece, s, azimuth);
        around.cross(along).length() as f32
    }

    /// The coordinate along the profile of a piece's parameter.
    fn v(&self, piece: usize, s: f64) -> f64 {
        let Piece { segment, range: [start, end], .. } = self.pieces[piece];
        (f64::from(segment) + start + (end - start) * s) / self.segment_count as f64
    }

    /// The piece's parameter for a coordinate along the profile.
    fn piece_parameter(&self, piece: usize, v: f64) -> f64 {
        let Piece { segment, range: [start, end], .. } = self.pieces[piece];
        let s = v * self.segment_count as f64 - f64::from(segment);
        ((s - start) / (end - start)).clamp(0.0, 1.0)
    }

    /// The bounding box, rounded outwards.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// The surface area.
    #[must_use]
    pub fn area(&self) -> f32 {
        self.area
    }

    /// Samples a point almost uniform in area, with its exact density; `None` if the surface has no
    /// area or was not prepared.
    #[must_use]
    pub fn sample_area(&self, random: Vec2) -> Option<ShapeSample> {
        Some(self.sampling.as_ref()?.sample(self, random))
    }

    /// The density per area with which [`Self::sample_area`] chooses the point with coordinate `v`
    /// and these derivatives by u and v.
    #[must_use]
    pub fn pdf_area(&self, v: f32, dp_du: Vec3, dp_dv: Vec3) -> f32 {
        self.sampling.as_ref().map_or(0.0, |table| table.pdf(v, dp_du, dp_dv))
    }

    /// Memory use in bytes.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.pieces.as_slice())
            + self.tree.memory_bytes()
            + self.sampling.as_ref().map_or(0, AreaTable::memory_bytes)
    }
}

/// The bounding box of the rotated control points.
fn bounds<'a>(to_world: &DAffine3, points: impl Iterator<Item = &'a DVec2>) -> Bounds3 {
    let axes = to_world.matrix3;
    // A circle with radius vectors a and b extends √(aᵢ² + bᵢ²) along each axis i.
    let reach = (axes.x_axis * axes.x_axis + axes.z_axis * axes.z_axis).map(f64::sqrt);
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for point in points {
        let center = to_world.translation + axes.y_axis * point.y;
        low = low.min(center - reach * point.x.abs());
        high = high.max(center + reach * point.x.abs());
    }
    Bounds3::new(low.as_vec3().map(f32::next_down), high.as_vec3().map(f32::next_up))
}
