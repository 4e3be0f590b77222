//! `bsplinecurve`: round tubes along cubic B-splines.

use super::{ShapeModel, SurfacePoint};
use crate::builder::Assets;
use crate::inputs::curve_file::{self, Curves};
use crate::manual::{Manual, parameter};
use etendue_bvh::{Hit, PrimitiveHit};
use etendue_document::Parameters;
use etendue_math::{Bounds3, Ray, coordinate_system, rounding_error_bound};
use glam::{DVec2, DVec3, DVec4, Vec2, Vec3};
use std::f32::consts::TAU;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Round tubes along uniform cubic B-splines, for hair, fur and wires: at each point of the \
              curve a circle across it, whose radius is a B-spline too. A file has one control point a \
              line, `x y z radius`, and an empty line between curves of at least four points; a curve \
              does not reach its end points unless they are tripled. Tubes are open at their ends, and \
              rays from within do not see them. The coordinate u runs around, v along all segments of \
              the file.",
    parameters: &[
        parameter("filename", "string", "", "The file."),
        parameter("radius", "float", "", "The radius where the file gives `x y z` only."),
        parameter("to_world", "transform", "", "Placement of the control points; radii stay."),
    ],
    sample: r#"<shape type="bsplinecurve"><string name="filename" value="curves.txt"/></shape>"#,
};

/// Pieces are halved until their bend is this fraction of their radius or length.
const BEND: f64 = 0.05;
/// The maximum number of halvings: 1024 pieces.
const MAX_HALVINGS: u32 = 10;
/// Segments overlap by this much in their parameter, so that no ray passes between them.
const OVERLAP: f64 = 1e-9;
/// The tolerance of an intersection's curve parameter.
const ACCURACY: f64 = 1e-13;

/// Tubes in world space.
#[derive(Clone, Debug)]
pub struct BSplineCurve {
    curves: Curves,
}

/// Reads tubes.
#[must_use]
pub fn build(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<BSplineCurve> {
    curve_file::read(assets, parameters, 4).map(|curves| BSplineCurve { curves })
}

/// A cubic segment by its Bézier control points: positions and radii.
type Bezier = [DVec4; 4];

/// The point and its first and second derivative at `s`.
fn evaluate([a, b, c, d]: &Bezier, s: f64) -> [DVec4; 3] {
    let r = 1.0 - s;
    let (ab, bc, cd) = (*a * r + *b * s, *b * r + *c * s, *c * r + *d * s);
    let (abc, bcd) = (ab * r + bc * s, bc * r + cd * s);
    [abc * r + bcd * s, (bcd - abc) * 3.0, (ab - bc * 2.0 + cd) * 6.0]
}

fn halve([a, b, c, d]: &Bezier) -> (Bezier, Bezier) {
    let (ab, bc, cd) = ((*a + *b) * 0.5, (*b + *c) * 0.5, (*c + *d) * 0.5);
    let (abc, bcd) = ((ab + bc) * 0.5, (bc + cd) * 0.5);
    let middle = (abc + bcd) * 0.5;
    ([*a, ab, abc, middle], [middle, bcd, cd, *d])
}

/// A segment in ray coordinates: x and y across the ray, z along it, relative to some point on the
/// ray. The radius is the last component.
struct View {
    curve: Bezier,
    halvings: u32,
    /// The valid range of the ray, in z.
    near: f64,
    far: f64,
    /// The z and curve parameter of the nearest intersection so far.
    found: Option<(f64, f64)>,
}

impl View {
    /// Searches for intersections on `part`, the part of the curve from `start` to `end`.
    fn search(&mut self, part: &Bezier, [start, end]: [f64; 2], halvings: u32) {
        if self.misses(part) {
            return;
        }
        if halvings < self.halvings {
            let (left, right) = halve(part);
            let middle = 0.5 * (start + end);
            self.search(&left, [start, middle], halvings + 1);
            self.search(&right, [middle, end], halvings + 1);
            return;
        }
        let start = if start == 0.0 { -OVERLAP } else { start };
        let end = if end == 1.0 { 1.0 + OVERLAP } else { end };
        self.cross(-1.0, [start, end]);
        self.cross(1.0, [start, end]);
    }

    /// Whether the convex hull of a part misses the ray.
    fn misses(&self, part: &Bezier) -> bool {
        let low = part.iter().copied().reduce(DVec4::min).unwrap_or_default();
        let high = part.iter().copied().reduce(DVec4::max).unwrap_or_default();
        let reach = high.w;
        low.x > reach
            || high.x < -reach
            || low.y > reach
            || high.y < -reach
            || low.z - reach > self.far
            || high.z + reach < self.near
    }

    /// Zero where the tube's surface meets the ray. `side` selects the point where the ray enters
    /// (−1) or leaves (1) the sphere around the curve's point. The value is that point's signed
    /// distance from the plane across the curve, times the length of the derivative. If the ray
    /// misses the sphere, its nearest point is used.
    fn mismatch(&self, side: f64, s: f64) -> f64 {
        let [point, derivative, _] = evaluate(&self.curve, s);
        let across = DVec2::new(point.x, point.y);
        let depth = side * (point.w * point.w - across.length_squared()).max(0.0).sqrt();
        depth * derivative.z - across.dot(DVec2::new(derivative.x, derivative.y))
    }

    /// Searches for an intersection before or behind the curve.
    ///
    /// A point of the tube lies one radius from the curve, at right angles to it. On a ray, this
    /// gives one equation for each of its two intersections with a sphere around the curve. Both
    /// have simple roots even for rays at right angles to the curve, where the squared equation
    /// would have double roots.
    fn cross(&mut self, side: f64, [mut low, mut high]: [f64; 2]) {
        let (mut at_low, mut at_high) = (self.mismatch(side, low), self.mismatch(side, high));
        if (at_low < 0.0) == (at_high < 0.0) {
            return;
        }
        // Regula falsi (Illinois variant), with bisection in every third step.
        let mut last_moved_low = None;
        for step in 0..100 {
            if high - low < ACCURACY {
                break;
            }
            let falsi = high - at_high * (high - low) / (at_high - at_low);
            let is_inside = falsi > low && falsi < high;
            let s = if step % 3 < 2 && is_inside { falsi } else { 0.5 * (low + high) };
            let at = self.mismatch(side, s);
            if at == 0.0 {
                (low, high) = (s, s);
                break;
            }
            let moves_low = (at < 0.0) == (at_low < 0.0);
            if moves_low {
                (low, at_low) = (s, at);
            } else {
                (high, at_high) = (s, at);
            }
            if last_moved_low == Some(moves_low) {
                if moves_low { at_high *= 0.5 } else { at_low *= 0.5 }
            }
            last_moved_low = Some(moves_low);
        }
        self.offer(side, 0.5 * (low + high));
    }

    /// Records an intersection if it is valid, enters from outside and is the nearest so far.
    fn offer(&mut self, side: f64, s: f64) {
        let [point, derivative, second] = evaluate(&self.curve, s);
        let beneath = point.w * point.w - point.x * point.x - point.y * point.y;
        if beneath < 0.0 {
            return;
        }
        let depth = side * beneath.sqrt();
        let radial = DVec3::new(-point.x, -point.y, depth);
        let z = point.z + depth;
        let normal = normal(radial, derivative, second, point.w);
        let is_nearer = self.found.is_none_or(|(nearest, _)| z < nearest);
        if normal.z < 0.0 && z > self.near && z < self.far && is_nearer {
            self.found = Some((z, s));
        }
    }
}

/// A normal of the tube at offset `radial` from the curve, not normalised. A changing radius tilts
/// it along the curve, and more so near the curve's centre of curvature.
fn normal(radial: DVec3, derivative: DVec4, second: DVec4, radius: f64) -> DVec3 {
    let along = derivative.truncate();
    let stretch = along.length_squared() - radial.dot(second.truncate());
    radial * stretch - along * (derivative.w * radius)
}

impl ShapeModel for BSplineCurve {
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
        let (t, s) = self.intersect(primitive, ray)?;
        Some(PrimitiveHit { t, u: s, v: 0.0 })
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.surface_point(hit.primitive, ray, (hit.t, hit.u))
    }

    fn memory_bytes(&self) -> usize {
        self.memory_bytes()
    }
}

impl BSplineCurve {
    /// Converts a segment to Bézier form.
    fn segment(&self, segment: u32) -> Bezier {
        let [a, b, c, d] = [0, 1, 2, 3].map(|index| self.curves.point(segment, index).as_dvec4());
        let third = |a: DVec4, b: DVec4| (a * 2.0 + b) / 3.0;
        let joint = |a: DVec4, b: DVec4, c: DVec4| (a + b * 4.0 + c) / 6.0;
        [joint(a, b, c), third(b, c), third(c, b), joint(b, c, d)]
    }

    /// The distance at which the ray enters the tube of a segment from outside, and the segment's
    /// parameter there.
    #[must_use]
    pub fn intersect(&self, segment: u32, ray: &Ray) -> Option<(f32, f32)> {
        let curve = self.segment(segment);
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let length = direction.length();
        let forward = direction / length;
        let (x, y) = forward.any_orthonormal_pair();
        // Start from the ray's point nearest to the curve, to keep precision for distant ray
        // origins.
        let start = (curve[0].truncate() - origin).dot(forward);
        let middle = origin + forward * start;
        let seen = curve.map(|point| {
            let offset = point.truncate() - middle;
            DVec4::new(offset.dot(x), offset.dot(y), offset.dot(forward), point.w)
        });
        let mut view = View {
            curve: seen,
            halvings: halvings(&seen),
            near: -start,
            far: f64::from(ray.t_max) * length - start,
            found: None,
        };
        view.search(&seen, [0.0, 1.0], 0);
        let (z, s) = view.found?;
        let t = ((z + start) / length) as f32;
        (t > 0.0 && t < ray.t_max).then_some((t, s as f32))
    }

    /// The surface point where `ray` enters a segment, from the distance and parameter that
    /// [`Self::intersect`] returned.
    #[inline(never)]
    #[must_use]
    pub fn surface_point(&self, index: u32, ray: &Ray, (t, s): (f32, f32)) -> SurfacePoint {
        let curve = self.segment(index);
        let place = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t);
        let s = nearest(&curve, place, f64::from(s));
        let [point, derivative, second] = evaluate(&curve, s);
        let (center, along) = (point.truncate(), derivative.truncate());
        let axis = along.normalize_or(DVec3::Z);
        let offset = place - center;
        let outwards =
            (offset - axis * offset.dot(axis)).normalize_or(axis.any_orthonormal_vector());
        let radial = outwards * point.w;
        let normal = normal(radial, derivative, second, point.w).normalize_or(outwards);
        let normal = normal.as_vec3().normalize();
        let place = (center + radial).as_vec3();
        let count = self.curves.starts.len() as f32;
        let (axis, outwards) = (axis.as_vec3(), outwards.as_vec3());
        let around = axis.cross(outwards) * (point.w as f32 * TAU);
        let has_tangents = around.length_squared() > 0.0 && along.length_squared() > 0.0;
        let (dp_du, dp_dv) = if has_tangents {
            (around, (along.as_vec3() + outwards * derivative.w as f32) * count)
        } else {
            coordinate_system(normal)
        };
        SurfacePoint {
            point: place,
            error: place.abs() * rounding_error_bound(2) + Vec3::splat(point.w as f32 * 1e-7),
            normal,
            shading_normal: normal,
            uv: Vec2::new(
                curve_file::azimuth(axis, outwards),
                ((f64::from(index) + s) / f64::from(count)) as f32,
            ),
            dp_du,
            dp_dv,
        }
    }

    /// The bounding box of each segment, from its Bézier control points.
    #[must_use]
    pub fn boxes(&self) -> Vec<Bounds3> {
        (0..self.curves.starts.len() as u32)
            .map(|segment| {
                let curve = self.segment(segment);
                let reach = DVec3::splat(curve.iter().map(|point| point.w).fold(0.0, f64::max));
                let points = curve.map(DVec4::truncate);
                let low = points.into_iter().fold(DVec3::INFINITY, DVec3::min) - reach;
                let high = points.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max) + reach;
                Bounds3::new(low.as_vec3().map(f32::next_down), high.as_vec3().map(f32::next_up))
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

/// How often a segment is halved. Each halving divides the bend by four.
fn halvings([a, b, c, d]: &Bezier) -> u32 {
    let bend = (*a - *b * 2.0 + *c).length().max((*b - *c * 2.0 + *d).length());
    let radius = [a, b, c, d].iter().map(|point| point.w).fold(0.0, f64::max);
    let size = radius.min((*d - *a).truncate().length());
    (1..MAX_HALVINGS)
        .find(|n| bend * 0.25_f64.powi(*n as i32) <= BEND * size)
        .unwrap_or(MAX_HALVINGS)
}

/// The curve parameter nearest to `place`. Refines `near` from single precision.
fn nearest(curve: &Bezier, place: DVec3, near: f64) -> f64 {
    let [point, derivative, second] = evaluate(curve, near);
    let (offset, along) = (place - point.truncate(), derivative.truncate());
    // One Newton step towards the parameter where the offset is orthogonal to the curve.
    let step = offset.dot(along) / (along.length_squared() - offset.dot(second.truncate()));
    (near + if step.abs() < 1e-3 { step } else { 0.0 }).clamp(0.0, 1.0)
}
