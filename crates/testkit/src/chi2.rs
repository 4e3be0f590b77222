//! Pearson's χ² test of samples against a claimed density.

use crate::TestRng;
use crate::partition::Partition;
use crate::pearson::{ChiSquareOutcome, MIN_EXPECTED, Rejection, compare};
use crate::quadrature::{Cubature, Guides, sphere_point};
use glam::{DVec2, Vec2, Vec3};
use std::cell::Cell;

/// The pilot run that shapes the cells draws one in this many samples, in addition.
const PILOT_DIVISOR: u64 = 8;
/// The tolerated deviation of the success rate in standard deviations: exceeded by chance in one of
/// half a million tests.
const RATE_DEVIATIONS: f64 = 5.0;

/// The settings of a χ² test, and its entry points: one method per domain.
///
/// Each method draws [`samples`](Self::samples) samples, and counts them in a grid of cells, which
/// is finer where a pilot run found many samples. It compares the counts with integrals of the
/// density over the cells, by adaptive cubature. It also checks that the density is finite and not
/// negative, positive at every sample, and that its integral equals the fraction of samples that
/// succeed.
///
/// A peak of the density that is much narrower than a cell and that the sampler misses is not
/// detected.
#[derive(Clone, Debug, PartialEq)]
pub struct ChiSquare {
    /// The number of samples, including failed ones. The pilot run draws an eighth more.
    pub samples: u64,
    /// Columns and rows of the grid. On the sphere: azimuth and cosine of the polar angle.
    pub resolution: (usize, usize),
    /// The probability of a false alarm in any of `test_count` tests.
    pub significance: f64,
    /// The number of tests that share this probability (Šidák's correction).
    pub test_count: u32,
    /// The seed of the generator passed to the sampler.
    pub seed: u64,
    /// The tolerated difference between the integral of the density and the success rate, in
    /// addition to chance.
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

    /// Tests unit directions against a density in solid angle. `None` means a failed sample.
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

    /// Tests points of the plane against a density in area. All of it must lie between the corners
    /// of `bounds`; samples outside are defects.
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

    /// Tests numbers in `range` against their density. The grid has as many cells as the whole
    /// [`resolution`](Self::resolution).
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
                // The second coordinate is arbitrary: it extends the line to a square.
                let point = DVec2::new((f64::from(x) - start) / length, random.next_f64());
                Some((point, f64::from(pdf(x)) * length))
            },
            |point| f64::from(pdf((start + length * point.x) as f32)) * length,
        )
    }

    /// Tests on the unit square. `sample` returns a point with its density; `density` is integrated.
    fn run(
        &self,
        mut sample: impl FnMut(&mut TestRng) -> Option<(DVec2, f64)>,
        density: impl Fn(DVec2) -> f64,
    ) -> ChiSquareOutcome {
        let mut random = TestRng::new(self.seed);
        let pilots: Vec<DVec2> = (0..self.samples / PILOT_DIVISOR)
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
        let expected = self.expected_fractions(&tally, &watched);
        self.judge(tally, &expected, bad_density.get())
    }

    /// The integral of the density over each cell.
    fn expected_fractions(&self, tally: &Tally, density: &impl Fn(DVec2) -> f64) -> Vec<f64> {
        let cubature = Cubature::new(density);
        let pilot_count = (self.samples / PILOT_DIVISOR).max(1) as f64;
        let cells = tally.partition.cells().iter();
        cells
            .zip(&tally.observed)
            .map(|(cell, &observed)| {
                let guides = Guides { points: &cell.pilots, mass: 1.0 / pilot_count };
                // So small a fraction of the count's standard deviation does not affect χ².
                let deviation = (observed as f64).max(MIN_EXPECTED).sqrt();
                let tolerance = 0.005 * deviation / self.samples.max(1) as f64;
                cubature.integrate(cell.rectangle, tolerance, guides)
            })
            .collect()
    }

    /// Rejects the density for the first defect found, or else for the χ² statistic.
    fn judge(
        &self,
        tally: Tally,
        fractions: &[f64],
        bad_density: Option<(DVec2, f64)>,
    ) -> ChiSquareOutcome {
        let successes: u64 = tally.observed.iter().sum::<u64>() + tally.outside;
        let success_rate = successes as f64 / self.samples.max(1) as f64;
        let pdf_integral: f64 = fractions.iter().sum();
        let mut outcome = compare(&tally.observed, fractions, self.level());
        outcome.cells = tally.partition.cells().iter().map(|cell| cell.rectangle).collect();
        outcome.success_rate = success_rate;
        outcome.pdf_integral = pdf_integral;
        let variance = success_rate * (1.0 - success_rate) / self.samples.max(1) as f64;
        let allowed = self.integral_tolerance + RATE_DEVIATIONS * variance.sqrt();
        // Causes take precedence over their consequences.
        if let Some((point, value)) = bad_density {
            outcome.rejection = Some(Rejection::BadDensity { point, value });
        } else if tally.outside > 0 {
            outcome.rejection = Some(Rejection::OutsideDomain { count: tally.outside });
        } else if tally.without_density > 0 {
            let count = tally.without_density;
            outcome.rejection = Some(Rejection::SampleWithoutDensity { count });
        } else if pdf_integral > 1.0 + self.integral_tolerance
            || (pdf_integral - success_rate).abs() > allowed
        {
            outcome.rejection = Some(Rejection::Integral { allowed });
        }
        outcome
    }

    /// The significance level of each test, by Šidák's correction.
    fn level(&self) -> f64 {
        1.0 - (1.0 - self.significance).powf(1.0 / f64::from(self.test_count.max(1)))
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

/// Whether the point is in the unit square; false for NaN.
fn inside_unit_square(point: DVec2) -> bool {
    point.cmpge(DVec2::ZERO).all() && point.cmple(DVec2::ONE).all()
}

/// The inverse of [`sphere_point`].
fn sphere_coordinates(direction: Vec3) -> DVec2 {
    let direction = direction.as_dvec3();
    if (direction.length_squared() - 1.0).abs() > 1e-4 {
        // Not a unit vector: NaN is outside every cell.
        return DVec2::NAN;
    }
    let turns = direction.y.atan2(direction.x) / std::f64::consts::TAU;
    // Near the poles, z has lost its precision, but x and y have not.
    let squared_sine = direction.truncate().length_squared();
    let from_pole = if direction.z.abs() > 0.5 {
        0.5 * squared_sine / (1.0 + (1.0 - squared_sine).max(0.0).sqrt())
    } else {
        0.5 * (1.0 - direction.z.abs())
    };
    let height = if direction.z < 0.0 { from_pole } else { 1.0 - from_pole };
    DVec2::new(turns.rem_euclid(1.0), height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pearson::chi2_discrete;
    use std::f32::consts::{FRAC_1_PI, TAU};

    /// Directions around +z with density (n + 1)/2π cosⁿθ.
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
        // Computes cosⁿθ from the sine, because the cosine loses precision near the axis.
        let squared_sine = direction.truncate().length_squared().min(1.0);
        (exponent + 1.0) / TAU * (0.5 * exponent * (-squared_sine).ln_1p()).exp()
    }

    #[test]
    fn true_densities_are_accepted() {
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
    fn a_rotated_peak_is_accepted() {
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
    fn failed_samples_reduce_the_expected_integral() {
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
    fn stray_samples_and_invalid_densities_are_reported() {
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
    fn line_and_plane_scale_with_their_size() {
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
    fn the_correction_distributes_the_significance() {
        let level = ChiSquare::one_of(100).level();
        assert!((1.0 - (1.0 - level).powi(100) - 0.01).abs() < 1e-12);
    }
}
