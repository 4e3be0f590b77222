//! Pearson's χ² test: do samples follow the density that is claimed for them?

use crate::TestRng;
use crate::partition::Partition;
use crate::quadrature::{Cubature, Guides, Rectangle, sphere_point};
use crate::special::chi_square_tail;
use glam::{DVec2, Vec2, Vec3};
use std::cell::Cell;
use std::fmt;

/// Cells that are expected to hold fewer samples are pooled, as χ² is an approximation for large
/// counts (Cochran, 1952).
const MIN_EXPECTED: f64 = 5.0;
/// The pilot run that shapes the cells draws this share of the samples, over again.
const PILOT_SHARE: u64 = 8;
/// Deviations of the success share that are put down to chance: one in half a million tests.
const SHARE_DEVIATIONS: f64 = 5.0;

/// The settings of a χ² test, and its entry points: one method per domain.
///
/// Each method draws [`samples`](Self::samples) samples, counts them in a grid of cells (cut finer
/// where a pilot run found the samples crowded), integrates the density over each cell by adaptive
/// cubature and compares. It also checks that the density is
/// finite and nowhere negative, positive at every sample, and that it integrates to the share of
/// samples that succeed.
///
/// A peak of the density far narrower than a cell, where the sampler puts nothing, is not seen.
#[derive(Clone, Debug, PartialEq)]
pub struct ChiSquare {
    /// How many samples are drawn, failed ones included; an eighth more for the pilot run.
    pub samples: u64,
    /// Columns and rows of the tally. On the sphere: azimuth and cosine of the polar angle.
    pub resolution: (usize, usize),
    /// The probability of a false alarm, over all `test_count` tests together.
    pub significance: f64,
    /// How many tests share that probability (Šidák's correction).
    pub test_count: u32,
    /// The seed of the generator handed to the sampler.
    pub seed: u64,
    /// By how much the integral of the density may miss the success share, beyond chance.
    pub integral_tolerance: f64,
}

impl Default for ChiSquare {
    fn default() -> Self {
        Self {
            samples: 400_000,
            resolution: (32, 16),
            significance: 0.01,
            test_count: 1,
            seed: 0x5eed,
            integral_tolerance: 1e-3,
        }
    }
}

impl ChiSquare {
    /// The default settings for one test out of `test_count`.
    #[must_use]
    pub fn one_of(test_count: u32) -> Self {
        Self { test_count, ..Self::default() }
    }

    /// Tests unit directions against a density in solid angle. `None` is a failed sample.
    pub fn sphere(
        &self,
        mut sample: impl FnMut(&mut TestRng) -> Option<Vec3>,
        pdf: impl Fn(Vec3) -> f32,
    ) -> ChiSquareOutcome {
        let area = 2.0 * std::f64::consts::TAU;
        self.run(
            |random| {
                let direction = sample(random)?;
                Some((sphere_coordinates(direction), f64::from(pdf(direction)) * area))
            },
            |point| f64::from(pdf(sphere_point(point))) * area,
        )
    }

    /// Tests points of the unit square against a density in area.
    pub fn square(
        &self,
        sample: impl FnMut(&mut TestRng) -> Option<Vec2>,
        pdf: impl Fn(Vec2) -> f32,
    ) -> ChiSquareOutcome {
        self.plane((Vec2::ZERO, Vec2::ONE), sample, pdf)
    }

    /// Tests points of the plane against a density in area. All mass must lie between the corners
    /// of `bounds`; a sample outside is counted as a defect.
    pub fn plane(
        &self,
        bounds: (Vec2, Vec2),
        mut sample: impl FnMut(&mut TestRng) -> Option<Vec2>,
        pdf: impl Fn(Vec2) -> f32,
    ) -> ChiSquareOutcome {
        let (min, size) = (bounds.0.as_dvec2(), (bounds.1 - bounds.0).as_dvec2());
        let area = size.x * size.y;
        self.run(
            |random| {
                let point = sample(random)?;
                Some(((point.as_dvec2() - min) / size, f64::from(pdf(point)) * area))
            },
            |point| f64::from(pdf((min + size * point).as_vec2())) * area,
        )
    }

    /// Tests numbers between the two ends of `range` against their density. The grid has as many
    /// cells as [`resolution`](Self::resolution) has altogether.
    pub fn line(
        &self,
        range: (f32, f32),
        mut sample: impl FnMut(&mut TestRng) -> Option<f32>,
        pdf: impl Fn(f32) -> f32,
    ) -> ChiSquareOutcome {
        let (start, length) = (f64::from(range.0), f64::from(range.1) - f64::from(range.0));
        let flat = Self { resolution: (self.resolution.0 * self.resolution.1, 1), ..self.clone() };
        flat.run(
            |random| {
                let x = sample(random)?;
                // The second coordinate carries no information: it makes the line a square.
                let point = DVec2::new((f64::from(x) - start) / length, random.next_f64());
                Some((point, f64::from(pdf(x)) * length))
            },
            |point| f64::from(pdf((start + length * point.x) as f32)) * length,
        )
    }

    /// The test on the unit square: `sample` gives a point with its density, `density` integrates.
    fn run(
        &self,
        mut sample: impl FnMut(&mut TestRng) -> Option<(DVec2, f64)>,
        density: impl Fn(DVec2) -> f64,
    ) -> ChiSquareOutcome {
        let mut random = TestRng::new(self.seed);
        let pilots: Vec<DVec2> = (0..self.samples / PILOT_SHARE)
            .filter_map(|_| sample(&mut random))
            .map(|(point, _)| point)
            .filter(|&point| inside_unit_square(point))
            .collect();
        let mut tally = Tally::new(Partition::new(self.resolution, &pilots));
        for _ in 0..self.samples {
            if let Some((point, density)) = sample(&mut random) {
                tally.add(point, density);
            }
        }
        let bad_density = Cell::new(None);
        let watched = |point: DVec2| {
            let value = density(point);
            if !(value.is_finite() && value >= 0.0) && bad_density.get().is_none() {
                bad_density.set(Some((point, value)));
            }
            value
        };
        let expected = self.expected_shares(&tally, &watched);
        self.judge(tally, &expected, bad_density.get())
    }

    /// The integral of the density over each cell.
    fn expected_shares(&self, tally: &Tally, density: &impl Fn(DVec2) -> f64) -> Vec<f64> {
        let cubature = Cubature::new(density);
        let pilot_count = (self.samples / PILOT_SHARE).max(1) as f64;
        let cells = tally.partition.cells().iter();
        cells
            .zip(&tally.observed)
            .map(|(cell, &observed)| {
                let guides = Guides { points: &cell.pilots, mass: 1.0 / pilot_count };
                // A share of the standard deviation of the count so small adds nothing to χ².
                let deviation = (observed as f64).max(MIN_EXPECTED).sqrt();
                let tolerance = 0.005 * deviation / self.samples.max(1) as f64;
                cubature.integrate(cell.rectangle, tolerance, guides)
            })
            .collect()
    }

    fn judge(
        &self,
        tally: Tally,
        shares: &[f64],
        bad_density: Option<(DVec2, f64)>,
    ) -> ChiSquareOutcome {
        let successes: u64 = tally.observed.iter().sum::<u64>() + tally.outside;
        let success_share = successes as f64 / self.samples.max(1) as f64;
        let pdf_integral: f64 = shares.iter().sum();
        let mut outcome = compare(&tally.observed, shares, self.level());
        outcome.cells = tally.partition.cells().iter().map(|cell| cell.rectangle).collect();
        outcome.success_share = success_share;
        outcome.pdf_integral = pdf_integral;
        let spread = success_share * (1.0 - success_share) / self.samples.max(1) as f64;
        let allowed = self.integral_tolerance + SHARE_DEVIATIONS * spread.sqrt();
        // The cause is named before its consequences.
        if let Some((point, value)) = bad_density {
            outcome.rejection = Some(Rejection::BadDensity { point, value });
        } else if tally.outside > 0 {
            outcome.rejection = Some(Rejection::OutsideDomain { count: tally.outside });
        } else if tally.without_density > 0 {
            let count = tally.without_density;
            outcome.rejection = Some(Rejection::SampleWithoutDensity { count });
        } else if pdf_integral > 1.0 + self.integral_tolerance
            || (pdf_integral - success_share).abs() > allowed
        {
            outcome.rejection = Some(Rejection::Integral { allowed });
        }
        outcome
    }

    /// The significance level left to each test by Šidák's correction.
    fn level(&self) -> f64 {
        1.0 - (1.0 - self.significance).powf(1.0 / f64::from(self.test_count.max(1)))
    }
}

/// Tests counts of outcomes against expected counts (or anything proportional to them), at the
/// significance level 0.01.
#[must_use]
pub fn chi2_discrete(observed: &[u64], expected: &[f64]) -> ChiSquareOutcome {
    let total: f64 = expected.iter().sum();
    let shares: Vec<f64> = expected.iter().map(|count| count / total).collect();
    let mut outcome = compare(observed, &shares, 0.01);
    if let Some(&value) = expected.iter().find(|count| !(count.is_finite() && **count >= 0.0)) {
        outcome.rejection = Some(Rejection::BadDensity { point: DVec2::ZERO, value });
    } else if observed.len() != expected.len() {
        outcome.rejection = Some(Rejection::Shape);
    }
    outcome
}

/// What a χ² test found.
#[derive(Clone, Debug, PartialEq)]
pub struct ChiSquareOutcome {
    /// Why the claim does not stand, if it does not.
    pub rejection: Option<Rejection>,
    /// Σ (observed − expected)² / expected over the pooled cells.
    pub statistic: f64,
    /// The pooled cells less one.
    pub degrees_of_freedom: usize,
    /// The probability of a statistic at least as large, if the density is the true one.
    pub p_value: f64,
    /// The level below which the p-value rejects.
    pub level: f64,
    /// The share of samples that did not fail.
    pub success_share: f64,
    /// The integral of the density over the whole domain.
    pub pdf_integral: f64,
    /// The cells, in the unit square that parametrises the domain; empty for a discrete test.
    pub cells: Vec<Rectangle>,
    /// Samples per cell.
    pub observed: Vec<u64>,
    /// Expected samples per cell, scaled to the same total.
    pub expected: Vec<f64>,
}

/// Why a χ² test rejects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rejection {
    /// The density is NaN, infinite or negative at a point of the parametrised domain.
    BadDensity {
        /// Where, in the unit square that parametrises the domain.
        point: DVec2,
        /// What was found there.
        value: f64,
    },
    /// Samples are not finite, or lie outside the domain.
    OutsideDomain {
        /// How many.
        count: u64,
    },
    /// Samples lie where their own density is zero (or not finite).
    SampleWithoutDensity {
        /// How many.
        count: u64,
    },
    /// The density does not integrate to the share of successful samples, or to more than one.
    Integral {
        /// The greatest difference put down to chance and integration.
        allowed: f64,
    },
    /// Too few cells are left after pooling to test anything.
    TooFewCells,
    /// The tables of observed and expected counts differ in length.
    Shape,
    /// The counts do not follow the density.
    Distribution,
}

impl ChiSquareOutcome {
    /// Whether the claimed density stands.
    #[must_use]
    pub fn accepted(&self) -> bool {
        self.rejection.is_none()
    }

    /// Asserts that the claimed density stands.
    ///
    /// # Panics
    /// With the outcome's whole report where it does not.
    #[track_caller]
    pub fn assert(&self) {
        assert!(self.accepted(), "{self}");
    }
}

impl fmt::Display for ChiSquareOutcome {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.rejection {
            None => writeln!(formatter, "the density stands")?,
            Some(rejection) => writeln!(formatter, "the density is rejected: {rejection:?}")?,
        }
        writeln!(
            formatter,
            "chi² {:.2} at {} degrees of freedom, p {:.3e}, level {:.3e}",
            self.statistic, self.degrees_of_freedom, self.p_value, self.level
        )?;
        writeln!(
            formatter,
            "success share {:.6}, integral of the density {:.6}",
            self.success_share, self.pdf_integral
        )?;
        self.write_worst_cells(formatter)
    }
}

impl ChiSquareOutcome {
    /// The ten cells that contribute most, as the whole tables would fill screens.
    fn write_worst_cells(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let contribution = |index: usize| {
            let expected = self.expected.get(index).copied().unwrap_or(0.0);
            (self.observed[index] as f64 - expected).powi(2) / expected.max(1.0)
        };
        let mut order: Vec<usize> = (0..self.observed.len()).collect();
        order.sort_by(|&a, &b| contribution(b).total_cmp(&contribution(a)));
        writeln!(formatter, "worst cells: observed, expected, where")?;
        for &index in order.iter().take(10) {
            let expected = self.expected.get(index).copied().unwrap_or(f64::NAN);
            write!(formatter, "  {index}: {}, {expected:.2}", self.observed[index])?;
            match self.cells.get(index) {
                Some(cell) => writeln!(formatter, ", {} to {}", cell.min, cell.max)?,
                None => writeln!(formatter)?,
            }
        }
        Ok(())
    }
}

/// The counts of a run.
struct Tally {
    partition: Partition,
    observed: Vec<u64>,
    outside: u64,
    without_density: u64,
}

impl Tally {
    fn new(partition: Partition) -> Self {
        let observed = vec![0; partition.cells().len()];
        Self { partition, observed, outside: 0, without_density: 0 }
    }

    fn add(&mut self, point: DVec2, density: f64) {
        if !inside_unit_square(point) {
            self.outside += 1;
            return;
        }
        if !(density.is_finite() && density > 0.0) {
            self.without_density += 1;
        }
        self.observed[self.partition.find(point)] += 1;
    }
}

/// False of NaN.
fn inside_unit_square(point: DVec2) -> bool {
    point.cmpge(DVec2::ZERO).all() && point.cmple(DVec2::ONE).all()
}

/// The point of the unit square that [`sphere_point`] maps to `direction`.
fn sphere_coordinates(direction: Vec3) -> DVec2 {
    let direction = direction.as_dvec3();
    if (direction.length_squared() - 1.0).abs() > 1e-4 {
        // Not a unit vector: outside every cell.
        return DVec2::NAN;
    }
    let turns = direction.y.atan2(direction.x) / std::f64::consts::TAU;
    // Near the poles z has no digits left, but x and y have all of theirs.
    let squared_sine = direction.truncate().length_squared();
    let from_pole = if direction.z.abs() > 0.5 {
        0.5 * squared_sine / (1.0 + (1.0 - squared_sine).max(0.0).sqrt())
    } else {
        0.5 * (1.0 - direction.z.abs())
    };
    let height = if direction.z < 0.0 { from_pole } else { 1.0 - from_pole };
    DVec2::new(turns.rem_euclid(1.0), height)
}

/// Pearson's test of counts against shares, conditional on the counts' total.
fn compare(observed: &[u64], shares: &[f64], level: f64) -> ChiSquareOutcome {
    let total: u64 = observed.iter().sum();
    let sum: f64 = shares.iter().sum();
    let scale = if sum > 0.0 { total as f64 / sum } else { 0.0 };
    let expected: Vec<f64> = shares.iter().map(|share| share * scale).collect();
    let pooled = pool(observed, &expected);
    let statistic = pooled
        .iter()
        .map(|&(observed, expected)| (observed - expected).powi(2) / expected)
        .sum::<f64>();
    let degrees_of_freedom = pooled.len().saturating_sub(1);
    let p_value = chi_square_tail(degrees_of_freedom.max(1) as f64, statistic);
    let rejection = if degrees_of_freedom == 0 {
        Some(Rejection::TooFewCells)
    } else if p_value >= level {
        None
    } else {
        // NaN lands here too.
        Some(Rejection::Distribution)
    };
    ChiSquareOutcome {
        rejection,
        statistic,
        degrees_of_freedom,
        p_value,
        level,
        success_share: 1.0,
        pdf_integral: sum,
        cells: Vec::new(),
        observed: observed.to_vec(),
        expected,
    }
}

/// Cells by rising expectation, the small ones merged until each expects enough samples.
fn pool(observed: &[u64], expected: &[f64]) -> Vec<(f64, f64)> {
    let mut cells: Vec<(f64, f64)> =
        observed.iter().zip(expected).map(|(&o, &e)| (o as f64, e)).collect();
    cells.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut pooled = Vec::with_capacity(cells.len());
    let mut open = (0.0, 0.0);
    for (observed, expected) in cells {
        open = (open.0 + observed, open.1 + expected);
        if open.1 >= MIN_EXPECTED {
            pooled.push(open);
            open = (0.0, 0.0);
        }
    }
    if open != (0.0, 0.0) {
        // Only where everything together expects too little, or expectations are not numbers.
        pooled.push(open);
    }
    pooled
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::{FRAC_1_PI, TAU};

    /// Directions about +z with density (n + 1)/2π cosⁿθ.
    fn power_cosine(random: &mut TestRng, exponent: f64) -> Vec3 {
        let z = random.next_f64().powf(1.0 / (exponent + 1.0));
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sine, cosine) = (std::f64::consts::TAU * random.next_f64()).sin_cos();
        Vec3::new((radius * cosine) as f32, (radius * sine) as f32, z as f32)
    }

    fn power_cosine_pdf(direction: Vec3, exponent: f32) -> f32 {
        if direction.z < 0.0 {
            return 0.0;
        }
        // cosⁿθ by way of the sine, as the cosine has no digits left near the axis.
        let squared_sine = direction.truncate().length_squared().min(1.0);
        (exponent + 1.0) / TAU * (0.5 * exponent * (-squared_sine).ln_1p()).exp()
    }

    #[test]
    fn true_densities_stand() {
        let test = ChiSquare::one_of(4);
        for exponent in [1.0_f32, 30.0, 3e3, 1e5] {
            test.sphere(
                |random| Some(power_cosine(random, f64::from(exponent))),
                |w| power_cosine_pdf(w, exponent),
            )
            .assert();
        }
    }

    #[test]
    fn a_peak_off_the_axis_stands_turned_too() {
        let turn = glam::Quat::from_rotation_arc(Vec3::Z, Vec3::new(0.48, -0.6, 0.64));
        ChiSquare::default()
            .sphere(
                |random| Some(turn * power_cosine(random, 1e5)),
                |w| power_cosine_pdf(turn.inverse() * w, 1e5),
            )
            .assert();
    }

    #[test]
    fn wrong_exponents_are_rejected() {
        for (sampled, claimed) in [(1.0, 1.03_f32), (30.0, 30.6), (3e3, 3.06e3)] {
            let outcome = ChiSquare::default().sphere(
                |random| Some(power_cosine(random, sampled)),
                |w| power_cosine_pdf(w, claimed),
            );
            assert_eq!(outcome.rejection, Some(Rejection::Distribution), "{outcome}");
        }
    }

    #[test]
    fn wrong_scales_are_rejected() {
        for scale in [0.99, 1.01] {
            let outcome = ChiSquare::default().sphere(
                |random| Some(power_cosine(random, 1.0)),
                |w| scale * power_cosine_pdf(w, 1.0),
            );
            assert!(matches!(outcome.rejection, Some(Rejection::Integral { .. })), "{outcome}");
        }
    }

    #[test]
    fn a_slight_azimuthal_dependence_is_rejected() {
        let outcome = ChiSquare::default().sphere(
            |random| Some(power_cosine(random, 1.0)),
            |w| FRAC_1_PI * w.z.max(0.0) * (1.0 + 0.04 * w.x),
        );
        assert_eq!(outcome.rejection, Some(Rejection::Distribution), "{outcome}");
    }

    #[test]
    fn failures_count_against_the_density() {
        let half = |random: &mut TestRng| {
            let direction = random.unit_vector();
            (direction.z > 0.0).then_some(direction)
        };
        let quarter_sphere = 0.25 * FRAC_1_PI;
        let pdf = move |w: Vec3| if w.z > 0.0 { quarter_sphere } else { 0.0 };
        let outcome = ChiSquare::default().sphere(half, pdf);
        outcome.assert();
        assert!((outcome.pdf_integral - 0.5).abs() < 1e-6);
        let outcome = ChiSquare::default().sphere(half, |w| 2.0 * pdf(w));
        assert!(matches!(outcome.rejection, Some(Rejection::Integral { .. })));
    }

    #[test]
    fn stray_samples_and_broken_densities_are_named() {
        let test = ChiSquare::default();
        let uniform = |random: &mut TestRng| Some(random.next_vec2());
        let hole = test.square(uniform, |p| if p.x < 0.001 { 0.0 } else { 1.001 });
        assert!(matches!(hole.rejection, Some(Rejection::SampleWithoutDensity { .. })));
        let outside = test.square(|random| Some(1.01 * random.next_vec2()), |_| 1.0);
        assert!(matches!(outside.rejection, Some(Rejection::OutsideDomain { .. })));
        let long = test.sphere(|random| Some(1.01 * random.unit_vector()), |_| 0.25 * FRAC_1_PI);
        assert!(matches!(long.rejection, Some(Rejection::OutsideDomain { .. })));
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            let outcome = test.square(uniform, |p| if p.x > 0.9 { bad } else { 1.0 });
            assert!(matches!(outcome.rejection, Some(Rejection::BadDensity { .. })));
        }
    }

    #[test]
    fn line_and_plane_scale_by_their_size() {
        let test = ChiSquare::one_of(2);
        test.line((-2.0, 6.0), |random| Some(random.range_f32(-2.0, 6.0)), |_| 0.125).assert();
        let bounds = (Vec2::new(-1.0, 2.0), Vec2::new(3.0, 2.5));
        let inside =
            |random: &mut TestRng| Some(bounds.0 + (bounds.1 - bounds.0) * random.next_vec2());
        test.plane(bounds, inside, |_| 0.5).assert();
        let tilted = test.line((0.0, 1.0), |random| Some(random.next_f32()), |x| 0.96 + 0.08 * x);
        assert_eq!(tilted.rejection, Some(Rejection::Distribution));
    }

    #[test]
    fn discrete_counts_are_judged() {
        chi2_discrete(&[102, 95, 103], &[1.0, 1.0, 1.0]).assert();
        assert!(!chi2_discrete(&[150, 75, 75], &[1.0, 1.0, 1.0]).accepted());
        assert!(!chi2_discrete(&[100, 100, 50], &[1.0, 1.0, 0.0]).accepted());
        let single = chi2_discrete(&[100], &[1.0]);
        assert_eq!(single.rejection, Some(Rejection::TooFewCells));
        assert_eq!(chi2_discrete(&[1, 2], &[1.0]).rejection, Some(Rejection::Shape));
    }

    #[test]
    fn p_values_are_uniform_when_the_density_is_true() {
        let mut bins = [0_u64; 10];
        for seed in 0..400 {
            let test = ChiSquare { seed, samples: 4000, resolution: (8, 8), ..Default::default() };
            let outcome = test.square(|random| Some(random.next_vec2()), |_| 1.0);
            bins[((outcome.p_value * 10.0) as usize).min(9)] += 1;
        }
        chi2_discrete(&bins, &[40.0; 10]).assert();
    }

    #[test]
    fn the_correction_shares_the_level() {
        let level = ChiSquare::one_of(100).level();
        assert!((1.0 - (1.0 - level).powi(100) - 0.01).abs() < 1e-12);
    }

    #[test]
    fn a_rejection_reports_the_cells() {
        let outcome = chi2_discrete(&[150, 75, 75], &[1.0, 1.0, 1.0]);
        let report = outcome.to_string();
        assert!(report.contains("Distribution") && report.contains("0: 150, 100.00"));
    }
}
