//! Random surfaces of revolution, rays at them, and an independent solver for their crossings.

use etendue_math::Ray;
use etendue_scene::models::profile::{self, Segment};
use etendue_scene::shape::revsurface::{Crossing, RevSurface};
use etendue_testkit::TestRng;
use glam::{DAffine3, DVec2, DVec3, Vec3};
use std::f32::consts::TAU;

/// The results of a number of rays.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Counts {
    /// Rays that were cast.
    pub(crate) rays: u64,
    /// Crossings that the oracle finds.
    pub(crate) crossings: u64,
    /// Crossings that the surface misses.
    pub(crate) missed: u64,
    /// Crossings that the oracle does not confirm.
    pub(crate) invented: u64,
    /// Lines that cross a closed surface an odd number of times.
    pub(crate) odd: u64,
    /// Hits farther than 10⁻⁵ of the surface's size from it.
    pub(crate) off: u64,
    /// Closest hits or shadow tests that differ from the first crossing ahead.
    pub(crate) inconsistent: u64,
    /// Rays excluded from `missed` and `invented`. They graze the surface, or pass the end of a
    /// segment, so closely that the oracle's rounding decides.
    pub(crate) undecided: u64,
    /// A missed or invented crossing: the ray, with the actual and the expected number of
    /// crossings.
    pub(crate) first_difference: Option<(Ray, usize, usize)>,
}

impl Counts {
    /// Adds other results.
    pub(crate) fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.crossings += other.crossings;
        self.missed += other.missed;
        self.invented += other.invented;
        self.odd += other.odd;
        self.off += other.off;
        self.inconsistent += other.inconsistent;
        self.undecided += other.undecided;
        self.first_difference = self.first_difference.or(other.first_difference);
    }

    /// Whether there are no failures.
    pub(crate) fn is_clean(&self) -> bool {
        let wrong = self.missed + self.invented + self.odd + self.off + self.inconsistent;
        // The oracle is unsure about one in 10¹⁰ positions. Most undecided rays are aimed at
        // edges or along tangents.
        wrong == 0 && self.rays > 0 && self.undecided * 1000 < self.rays
    }
}

/// A surface with its profile.
pub(crate) struct Subject {
    segments: Vec<Segment>,
    surface: RevSurface,
    is_closed: bool,
}

/// A random profile of size about one: open, with both ends on the axis, or a closed loop.
pub(crate) fn random_subject(random: &mut TestRng) -> Subject {
    let mut point = || {
        DVec2::new(
            f64::from(random.next_f32()) * 2.0 - 1.0,
            f64::from(random.next_f32()) * 2.0 - 1.0,
        )
    };
    let count = 4 + (point().x.abs() * 5.0) as usize;
    let kind = (point().x.abs() * 4.0) as usize;
    let mut points: Vec<DVec2> = (0..count).map(|_| point()).collect();
    let segments = match kind {
        0 => profile::from_b_spline(&points),
        1 => {
            points.extend_from_within(..3);
            profile::from_b_spline(&points)
        }
        kind => {
            points.truncate(if count >= 7 { 7 } else { 4 });
            if kind == 3 {
                points[0].x = 0.0;
                points.last_mut().expect("there are some").x = 0.0;
            }
            profile::from_bezier(&points).expect("there are 4 or 7")
        }
    };
    let surface =
        RevSurface::new(&segments, DAffine3::IDENTITY, false).expect("the profile is off the axis");
    Subject { segments, surface, is_closed: kind == 1 || kind == 3 }
}

impl Subject {
    /// A ray at the surface: arbitrary, perpendicular to the axis, along it, through it, along a
    /// tangent, or at the end of a segment.
    pub(crate) fn random_ray(&self, random: &mut TestRng) -> Ray {
        let origin = random.unit_vector() * (3.0 * random.next_f32());
        let target = random.unit_vector() * (1.4 * random.next_f32().sqrt());
        let ray = |target: Vec3| Ray::new(origin, (target - origin).normalize_or(Vec3::X));
        match (random.next_f32() * 12.0) as usize {
            0 => ray(Vec3::new(target.x, origin.y, target.z)),
            1 => ray(Vec3::new(origin.x, target.y, origin.z)),
            2 => ray(Vec3::new(0.0, target.y, 0.0)),
            3 => {
                let (point, normal) = self.random_place(random, random_share);
                let along = random.unit_vector().cross(normal).normalize_or(Vec3::X);
                Ray::new(point - along * (2.0 * random.next_f32()), along)
            }
            4 => ray(self.random_place(random, |_| 0.0).0),
            _ => ray(target),
        }
    }

    /// A point of the surface and the normal there.
    fn random_place(&self, random: &mut TestRng, share: fn(&mut TestRng) -> f64) -> (Vec3, Vec3) {
        let index = (random.next_f32() * self.segments.len() as f32) as usize;
        let segment = &self.segments[index.min(self.segments.len() - 1)];
        let s = share(random);
        let (point, tangent) = (profile::point(segment, s), profile::tangent(segment, s));
        let (sin, cos) = (TAU * random.next_f32()).sin_cos();
        let turned = |p: DVec2| Vec3::new(p.x as f32 * cos, p.y as f32, p.x as f32 * sin);
        (turned(point), turned(DVec2::new(-tangent.y, tangent.x)))
    }

    /// Casts `count` rays and compares their crossings.
    pub(crate) fn compare(&self, random: &mut TestRng, count: u64) -> Counts {
        let mut counts = Counts::default();
        for _ in 0..count {
            let ray = self.random_ray(random);
            counts.rays += 1;
            let found = self.surface.crossings(&ray);
            let ahead = found.iter().map(|c| c.t as f32).find(|t| *t > 0.0);
            let hit = self.surface.intersect(&ray);
            let is_consistent =
                hit.map(|(t, _)| t) == ahead && self.surface.occludes(&ray) == hit.is_some();
            counts.inconsistent += u64::from(!is_consistent);
            counts.odd += u64::from(self.is_closed && !found.len().is_multiple_of(2));
            if let Some((t, place)) = hit {
                let at = self.surface.surface_point(&ray, t, place).point;
                counts.off += u64::from((at - ray.at(t)).length() > 1e-5);
            }
            let (known, is_decided) = oracle(&self.segments, &ray);
            counts.crossings += known.len() as u64;
            if agree(&found, &known) {
                continue;
            }
            if is_decided {
                counts.first_difference.get_or_insert((ray, found.len(), known.len()));
                counts.missed += (known.len().saturating_sub(found.len())) as u64;
                counts.invented += (found.len().saturating_sub(known.len())) as u64;
                // The number agrees, but not the positions.
                counts.missed += u64::from(known.len() == found.len());
            } else {
                counts.undecided += 1;
            }
        }
        counts
    }
}

fn random_share(random: &mut TestRng) -> f64 {
    f64::from(random.next_f32())
}

/// A crossing found by the oracle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Known {
    t: f64,
    /// The rounding error of t.
    accuracy: f64,
}

/// Whether two lists of crossings agree.
fn agree(found: &[Crossing], known: &[Known]) -> bool {
    found.len() == known.len()
        && found
            .iter()
            .zip(known)
            .all(|(found, known)| (found.t - known.t).abs() < 1e-8 + known.accuracy)
}

/// Polynomial values below this fraction of the terms are rounding errors of the oracle, which
/// evaluates powers of the parameter whose terms cancel.
const ORACLE_ROUNDING: f64 = 1e-12;

/// The crossings of a ray's line with the surface, in order, and whether they are certain. The
/// elimination is the same, but it uses powers of the parameter on whole segments. The roots of
/// each derivative bracket those of the one before. None of this is shared with the tested code.
pub(crate) fn oracle(segments: &[Segment], ray: &Ray) -> (Vec<Known>, bool) {
    let (p, v) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let mut crossings = Vec::new();
    let mut is_decided = true;
    for segment in segments {
        let x = power_basis(segment.map(|p| p.x));
        let y = power_basis(segment.map(|p| p.y));
        if v.y == 0.0 {
            level_crossings(&x, &y, (p, v), &mut crossings, &mut is_decided);
            continue;
        }
        // (p v_y + (y − p_y) v) across the axis, squared, less (x v_y)².
        let across = |p_across: f64, v_across: f64| {
            let mut sum: Vec<f64> = y.iter().map(|c| c * v_across).collect();
            sum[0] += p_across * v.y - p.y * v_across;
            product(&sum, &sum)
        };
        let (a, b, c) = (across(p.x, v.x), across(p.z, v.z), product(&x, &x));
        let f: Vec<f64> = (0..7).map(|i| a[i] + b[i] - c[i] * v.y * v.y).collect();
        let scale: f64 = (0..7).map(|i| a[i].abs() + b[i].abs() + (c[i] * v.y * v.y).abs()).sum();
        let (roots, least) = roots(&f);
        is_decided &= least > ORACLE_ROUNDING * scale;
        // Evaluating the polynomial rounds it by about 10⁻¹⁵ of its terms. The root moves by that
        // over the slope, which is small for grazing and for nearly level rays.
        let (slope, steepness) = (derivative(&f), derivative(&y));
        crossings.extend(roots.iter().map(|s| {
            let shift = 1e-14 * scale / value(&slope, *s).abs();
            let accuracy = shift * (value(&steepness, *s) / v.y).abs();
            Known { t: (value(&y, *s) - p.y) / v.y, accuracy }
        }));
    }
    crossings.sort_by(|a, b| a.t.total_cmp(&b.t));
    (crossings, is_decided)
}

fn level_crossings(
    x: &[f64],
    y: &[f64],
    (p, v): (DVec3, DVec3),
    crossings: &mut Vec<Known>,
    is_decided: &mut bool,
) {
    let mut shifted = y.to_vec();
    shifted[0] -= p.y;
    let (roots, least) = roots(&shifted);
    *is_decided &= least > ORACLE_ROUNDING;
    for s in roots {
        let radius = value(x, s);
        let a = v.x * v.x + v.z * v.z;
        let b = p.x * v.x + p.z * v.z;
        let cross = p.x * v.z - p.z * v.x;
        let discriminant = (radius * radius * a - cross * cross) / (a * a);
        *is_decided &= discriminant.abs() > ORACLE_ROUNDING;
        if discriminant >= 0.0 {
            let half = discriminant.sqrt();
            // Grazing rays again; the slope of the height has been checked.
            let accuracy = 1e-12 / half;
            let at = |side: f64| Known { t: -b / a + side * half, accuracy };
            crossings.extend([-1.0, 1.0].map(at));
        }
    }
}

fn power_basis([a, b, c, d]: [f64; 4]) -> Vec<f64> {
    vec![a, 3.0 * (b - a), 3.0 * (a - 2.0 * b + c), d - a + 3.0 * (b - c)]
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            result[i + j] += a * b;
        }
    }
    result
}

fn value(polynomial: &[f64], s: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

fn derivative(polynomial: &[f64]) -> Vec<f64> {
    polynomial.iter().enumerate().skip(1).map(|(i, c)| c * i as f64).collect()
}

/// The sign changes in [0, 1], and the least magnitude among the ends and the extrema.
fn roots(polynomial: &[f64]) -> (Vec<f64>, f64) {
    let mut ends = vec![0.0, 1.0];
    if polynomial.len() > 2 {
        ends.splice(1..1, roots(&derivative(polynomial)).0);
    }
    let values: Vec<f64> = ends.iter().map(|s| value(polynomial, *s)).collect();
    let least = values.iter().fold(f64::INFINITY, |least, v| least.min(v.abs()));
    let mut found = Vec::new();
    for i in 1..ends.len() {
        if (values[i - 1] < 0.0) != (values[i] < 0.0) {
            found.push(bisect(polynomial, ends[i - 1], ends[i]));
        }
    }
    (found, least)
}

/// The root between two parameters with different signs, by regula falsi (Illinois), followed by
/// bisection. The first takes at most as many steps as bisection needs.
fn bisect(polynomial: &[f64], mut low: f64, mut high: f64) -> f64 {
    let (mut at_low, mut at_high) = (value(polynomial, low), value(polynomial, high));
    for step in 0..120 {
        let falsi = high - at_high * (high - low) / (at_high - at_low);
        let middle =
            if step < 60 && falsi > low && falsi < high { falsi } else { 0.5 * (low + high) };
        let at_middle = value(polynomial, middle);
        if at_middle == 0.0 || high - low < 1e-15 {
            return middle;
        }
        if (at_middle < 0.0) == (at_low < 0.0) {
            (low, at_low) = (middle, at_middle);
            at_high *= 0.5;
        } else {
            (high, at_high) = (middle, at_middle);
            at_low *= 0.5;
        }
    }
    0.5 * (low + high)
}
