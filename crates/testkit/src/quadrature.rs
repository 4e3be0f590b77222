//! Numerical integration: Gauss–Legendre, adaptive Simpson, adaptive cubature of rectangles and
//! spheres.

use crate::rectangle::{Rectangle, crowded_axis};
use glam::{DVec2, Vec3};
use std::f64::consts::{PI, TAU};

/// The distance of the cubature's outer nodes from the edges in half widths: a discontinuity of the
/// density on an edge of the rectangle belongs to neither side.
const EDGE_INSET: f64 = 1e-6;
/// The maximum number of halvings of a rectangle: either side can shrink by 2²⁰.
const MAX_DEPTH: u32 = 40;
/// The maximum number of rectangles per integral, which stops the refinement of rounding noise.
const MAX_RECTANGLES: u32 = 100_000;
/// Fewer guide points than this in one rectangle may be chance.
const MIN_GUIDES: usize = 3;
/// A rectangle hides a peak if its estimate is below this fraction of the mass of its guides.
const GUIDED_FRACTION: f64 = 0.1;

/// The nodes and weights of the Gauss–Legendre rule with `count` nodes on [−1, 1].
///
/// The rule is exact for polynomials of degree 2 `count` − 1. Newton's iteration on the Legendre
/// polynomial (*Numerical Recipes*, 4.6).
#[must_use]
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let order = count as f64;
    (0..count)
        .map(|index| {
            let mut node = -(PI * (index as f64 + 0.75) / (order + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (value, derivative) = legendre(count, node);
                slope = derivative;
                let step = value / derivative;
                node -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (node, 2.0 / ((1.0 - node * node) * slope * slope))
        })
        .collect()
}

/// The Legendre polynomial of a degree (≥ 1) and its derivative, at `x` in (−1, 1).
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut current) = (1.0, x);
    for k in 2..=degree {
        let k = k as f64;
        (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
    }
    (current, degree as f64 * (x * current - previous) / (x * x - 1.0))
}

/// ∫ `function` from `start` to `end`, by the Gauss–Legendre rule with `count` nodes.
pub fn integrate_gauss(function: impl Fn(f64) -> f64, start: f64, end: f64, count: usize) -> f64 {
    let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
    half * gauss_legendre(count)
        .iter()
        .map(|&(node, weight)| weight * function(middle + half * node))
        .sum::<f64>()
}

/// ∫ `function` from `start` to `end` to about the absolute `tolerance`, by adaptive Simpson
/// quadrature.
///
/// The interval is first divided in 16, so that peaks wider than a hundredth of it are found. Each
/// part is halved at most 30 times (Lyness, 1969, with Richardson's correction).
pub fn adaptive_simpson(
    function: impl Fn(f64) -> f64,
    start: f64,
    end: f64,
    tolerance: f64,
) -> f64 {
    const PIECES: u32 = 16;
    let width = (end - start) / f64::from(PIECES);
    (0..PIECES)
        .map(|index| {
            let low = start + width * f64::from(index);
            let panel = Panel::new(&function, low, low + width);
            panel.refine(&function, tolerance / f64::from(PIECES), 30)
        })
        .sum()
}

/// A panel of Simpson's rule, with the values computed so far.
struct Panel {
    start: f64,
    end: f64,
    values: [f64; 3],
}

impl Panel {
    fn new(function: &impl Fn(f64) -> f64, start: f64, end: f64) -> Self {
        let values = [function(start), function(0.5 * (start + end)), function(end)];
        Self { start, end, values }
    }

    fn integral(&self) -> f64 {
        let [left, middle, right] = self.values;
        (self.end - self.start) / 6.0 * (left + 4.0 * middle + right)
    }

    fn refine(&self, function: &impl Fn(f64) -> f64, tolerance: f64, depth: u32) -> f64 {
        let middle = 0.5 * (self.start + self.end);
        let quarters = [0.5 * (self.start + middle), 0.5 * (middle + self.end)].map(function);
        let [left, centre, right] = self.values;
        let halves = [
            Self { start: self.start, end: middle, values: [left, quarters[0], centre] },
            Self { start: middle, end: self.end, values: [centre, quarters[1], right] },
        ];
        let finer: f64 = halves.iter().map(Self::integral).sum();
        let difference = finer - self.integral();
        if depth == 0 || difference.abs() <= 15.0 * tolerance {
            return finer + difference / 15.0;
        }
        halves.iter().map(|half| half.refine(function, 0.5 * tolerance, depth - 1)).sum()
    }
}

/// Points drawn from (approximately) the density to be integrated.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Guides<'a> {
    /// The points.
    pub(crate) points: &'a [DVec2],
    /// The fraction of the integral that each point stands for.
    pub(crate) mass: f64,
}

/// Adaptive cubature of a function over rectangles, by a tensor Lobatto rule and halving.
///
/// A rectangle is halved along the axis that changes the estimate most, until the change is below
/// the tolerance. [`Guides`] reveal peaks that are narrower than the distance of the nodes.
pub(crate) struct Cubature<'a, F> {
    function: &'a F,
    rule: [(f64, f64); 5],
}

impl<'a, F: Fn(DVec2) -> f64> Cubature<'a, F> {
    pub(crate) fn new(function: &'a F) -> Self {
        // Exact for polynomials up to degree 7 in each variable. Unlike Gauss nodes, Lobatto nodes
        // reach the edges, so a discontinuity cannot hide in a strip there.
        let (inner, outer) = ((3.0_f64 / 7.0).sqrt(), 1.0 - EDGE_INSET);
        let rule = [
            (-outer, 1.0 / 10.0),
            (-inner, 49.0 / 90.0),
            (0.0, 32.0 / 45.0),
            (inner, 49.0 / 90.0),
            (outer, 1.0 / 10.0),
        ];
        Self { function, rule }
    }

    /// The integral over `rectangle` to about the absolute `tolerance`.
    pub(crate) fn integrate(
        &self,
        rectangle: Rectangle,
        tolerance: f64,
        guides: Guides<'_>,
    ) -> f64 {
        let mut budget = MAX_RECTANGLES;
        let node = Node { rectangle, coarse: self.estimate(rectangle), tolerance, depth: 0 };
        self.refine(&node, guides, &mut budget)
    }

    fn estimate(&self, rectangle: Rectangle) -> f64 {
        let half = 0.5 * (rectangle.max - rectangle.min);
        let middle = 0.5 * (rectangle.max + rectangle.min);
        let mut sum = 0.0;
        for &(y, weight_y) in &self.rule {
            for &(x, weight_x) in &self.rule {
                let point = middle + half * DVec2::new(x, y);
                sum += weight_x * weight_y * (self.function)(point);
            }
        }
        sum * half.x * half.y
    }

    fn refine(&self, node: &Node, guides: Guides<'_>, budget: &mut u32) -> f64 {
        let halves = [node.rectangle.halves(0), node.rectangle.halves(1)];
        let parts = halves.map(|pair| pair.map(|half| self.estimate(half)));
        let finer = parts.map(|[low, high]| low + high);
        let mean = 0.5 * (finer[0] + finer[1]);
        if node.depth == MAX_DEPTH || *budget == 0 || !mean.is_finite() {
            return mean;
        }
        let changes = finer.map(|sum| (sum - node.coarse).abs());
        let count = guides.points.len();
        let axis = if changes[0].max(changes[1]) > node.tolerance {
            usize::from(changes[1] > changes[0])
        } else if count >= MIN_GUIDES && mean < GUIDED_FRACTION * guides.mass * count as f64 {
            crowded_axis(&halves, guides.points)
        } else {
            return mean;
        };
        *budget -= 1;
        let mut sum = 0.0;
        for (rectangle, coarse) in halves[axis].into_iter().zip(parts[axis]) {
            let points: Vec<DVec2> =
                guides.points.iter().copied().filter(|&point| rectangle.contains(point)).collect();
            // After d halvings, an edge crosses about 2^(d/2) rectangles, which share the error.
            let tolerance = node.tolerance * std::f64::consts::FRAC_1_SQRT_2;
            let child = Node { rectangle, coarse, tolerance, depth: node.depth + 1 };
            sum += self.refine(&child, Guides { points: &points, ..guides }, budget);
        }
        sum
    }
}

/// A rectangle that is being refined, and the estimate of its integral.
struct Node {
    rectangle: Rectangle,
    coarse: f64,
    tolerance: f64,
    depth: u32,
}

/// The direction of a point of the unit square: azimuth 2πx, cosine of the polar angle 2y − 1.
///
/// The map preserves areas up to a factor: a part of the square covers 4π times its area in solid
/// angle.
#[must_use]
pub(crate) fn sphere_point(point: DVec2) -> Vec3 {
    let z = 2.0 * point.y - 1.0;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sine, cosine) = (TAU * point.x).sin_cos();
    Vec3::new((radius * cosine) as f32, (radius * sine) as f32, z as f32)
}

/// ∫ `function` over all directions, in solid angle, to about the absolute `tolerance`.
pub fn integrate_sphere(function: impl Fn(Vec3) -> f64, tolerance: f64) -> f64 {
    integrate_band(&function, 0.0, tolerance)
}

/// ∫ `function` over the directions with z > 0, in solid angle, to about the absolute `tolerance`.
pub fn integrate_hemisphere(function: impl Fn(Vec3) -> f64, tolerance: f64) -> f64 {
    integrate_band(&function, 0.5, tolerance)
}

fn integrate_band(function: &impl Fn(Vec3) -> f64, low: f64, tolerance: f64) -> f64 {
    let density = |point: DVec2| function(sphere_point(point));
    let cubature = Cubature::new(&density);
    let band = Rectangle { min: DVec2::new(0.0, low), max: DVec2::ONE };
    let counts = (16, 16);
    let cell_tolerance = tolerance / (2.0 * TAU * (counts.0 * counts.1) as f64);
    let mut sum = 0.0;
    for row in 0..counts.1 {
        for column in 0..counts.0 {
            sum += cubature.integrate(
                band.cell((column, row), counts),
                cell_tolerance,
                Guides::default(),
            );
        }
    }
    2.0 * TAU * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_rules_are_exact_up_to_their_degree() {
        for count in 1..12 {
            for power in 0..2 * count {
                let integral = integrate_gauss(|x| x.powi(power as i32), -1.0, 1.0, count);
                let exact = if power % 2 == 0 { 2.0 / (power + 1) as f64 } else { 0.0 };
                assert!((integral - exact).abs() < 1e-13, "{count} nodes, power {power}");
            }
            let beyond = integrate_gauss(|x| x.powi(2 * count as i32), -1.0, 1.0, count);
            assert!((beyond - 2.0 / (2 * count + 1) as f64).abs() > 1e-8);
        }
    }

    #[test]
    fn simpson_resolves_kinks_and_narrow_peaks() {
        let kink = adaptive_simpson(|x| (x - 0.3).abs(), 0.0, 1.0, 1e-10);
        assert!((kink - (0.045 + 0.245)).abs() < 1e-9);
        let peak = adaptive_simpson(|x| (-((x - 0.41) / 0.01).powi(2)).exp(), 0.0, 1.0, 1e-12);
        assert!((peak - 0.01 * PI.sqrt()).abs() < 1e-11);
    }

    #[test]
    fn sphere_integrals_have_their_closed_forms() {
        assert!((integrate_sphere(|_| 1.0, 1e-9) - 2.0 * TAU).abs() < 1e-8);
        let squared = integrate_sphere(|w| f64::from(w.x * w.x), 1e-7);
        assert!((squared - 2.0 * TAU / 3.0).abs() < 1e-6);
        let cosine = integrate_hemisphere(|w| f64::from(w.z), 1e-7);
        assert!((cosine - PI).abs() < 1e-6);
    }

    #[test]
    fn discontinuities_are_resolved() {
        // A cap around an axis that is not aligned with the cells.
        let axis = Vec3::new(0.48, -0.6, 0.64);
        let cap = integrate_sphere(|w| if w.dot(axis) > 0.9 { 1.0 } else { 0.0 }, 1e-4);
        assert!((cap - TAU * 0.1).abs() < 5e-4, "{cap}");
    }

    #[test]
    fn guides_reveal_a_peak_between_the_nodes() {
        let centre = DVec2::new(0.413, 0.377);
        let width = 1e-4;
        let peak = |point: DVec2| (-(point - centre).length_squared() / (width * width)).exp();
        let exact = PI * width * width;
        let cubature = Cubature::new(&peak);
        let blind = cubature.integrate(Rectangle::UNIT, 1e-14, Guides::default());
        assert!(blind < 0.5 * exact, "the peak should hide from the plain rule");
        let mut random = crate::TestRng::new(8);
        let mut draw =
            || centre + DVec2::new(random.normal(), random.normal()) * width * 0.5_f64.sqrt();
        let points: Vec<DVec2> = (0..1000).map(|_| draw()).collect();
        let guides = Guides { points: &points, mass: exact / 1000.0 };
        let guided = cubature.integrate(Rectangle::UNIT, 1e-14, guides);
        assert!((guided / exact - 1.0).abs() < 5e-3, "{guided} {exact}");
    }
}
