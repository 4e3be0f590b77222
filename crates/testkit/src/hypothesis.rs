//! Running moments, and tests of means: normal with known variance, Student's t, Welch's.

use crate::special::{normal_tail, student_two_sided};

/// The mean and variance of a stream of numbers (Welford, 1962).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accumulator {
    count: u64,
    mean: f64,
    squared_deviations: f64,
}

impl Accumulator {
    /// Adds a number.
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let deviation = value - self.mean;
        self.mean += deviation / self.count as f64;
        self.squared_deviations += deviation * (value - self.mean);
    }

    /// Adds all numbers of another accumulator (Chan, Golub and LeVeque, 1979).
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let total = (self.count + other.count) as f64;
        let difference = other.mean - self.mean;
        let fraction = other.count as f64 / total;
        self.squared_deviations +=
            other.squared_deviations + difference * difference * self.count as f64 * fraction;
        self.mean += difference * fraction;
        self.count += other.count;
    }

    /// The number of numbers added.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The sample mean; zero for an empty sample.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The unbiased sample variance; infinite (unknown) for fewer than two numbers.
    #[must_use]
    pub fn variance(&self) -> f64 {
        if self.count < 2 {
            return f64::INFINITY;
        }
        self.squared_deviations / (self.count - 1) as f64
    }

    /// The standard error of the mean.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count.max(1) as f64).sqrt()
    }
}

impl FromIterator<f64> for Accumulator {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut accumulator = Self::default();
        for value in values {
            accumulator.add(value);
        }
        accumulator
    }
}

/// The result of a two-sided test of a mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TestOutcome {
    /// The test statistic: the deviation in units of the standard error.
    pub statistic: f64,
    /// The probability of a statistic at least as extreme, if the hypothesis is true.
    pub p_value: f64,
}

impl TestOutcome {
    /// Whether the hypothesis is accepted at this significance level (0.01: one false alarm in 100).
    ///
    /// If a number is NaN, so is the p-value, and the hypothesis is rejected.
    #[must_use]
    pub fn accepts(&self, significance: f64) -> bool {
        self.p_value >= significance
    }

    fn new(deviation: f64, error: f64, two_sided: impl Fn(f64) -> f64) -> Self {
        // Without variance, equality decides.
        let statistic = if deviation == 0.0 { 0.0 } else { deviation / error };
        Self { statistic, p_value: two_sided(statistic) }
    }
}

/// Tests whether the mean is `expected`, if each number has the known `variance` (z-test).
#[must_use]
pub fn z_test(sample: &Accumulator, expected: f64, variance: f64) -> TestOutcome {
    let error = (variance / sample.count().max(1) as f64).sqrt();
    TestOutcome::new(sample.mean() - expected, error, |z| 2.0 * normal_tail(z.abs()))
}

/// Tests whether the mean is `expected`; the variance is estimated from the sample (Student's
/// t-test).
#[must_use]
pub fn t_test(sample: &Accumulator, expected: f64) -> TestOutcome {
    let degrees = sample.count().saturating_sub(1).max(1) as f64;
    TestOutcome::new(sample.mean() - expected, sample.standard_error(), |t| {
        student_two_sided(degrees, t)
    })
}

/// Tests whether two samples have the same mean; their variances are unknown and may differ (Welch,
/// 1947).
#[must_use]
pub fn welch(first: &Accumulator, second: &Accumulator) -> TestOutcome {
    let squared = |sample: &Accumulator| sample.standard_error().powi(2);
    let (a, b) = (squared(first), squared(second));
    let degrees_of = |sample: &Accumulator| sample.count().saturating_sub(1).max(1) as f64;
    // The Welch–Satterthwaite equation, which does not apply to two samples without variance.
    let fourth = a * a / degrees_of(first) + b * b / degrees_of(second);
    let degrees = if fourth > 0.0 { (a + b).powi(2) / fourth } else { 1.0 };
    TestOutcome::new(first.mean() - second.mean(), (a + b).sqrt(), |t| {
        student_two_sided(degrees, t)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TestRng;

    #[test]
    fn moments_of_a_known_list() {
        let accumulator: Accumulator =
            [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter().collect();
        assert_eq!(accumulator.mean(), 5.0);
        assert!((accumulator.variance() - 32.0 / 7.0).abs() < 1e-12);
        assert!((accumulator.standard_error() - (4.0_f64 / 7.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn merging_equals_one_stream() {
        let mut random = TestRng::new(3);
        let values: Vec<f64> = (0..100).map(|_| random.normal() + 1e3).collect();
        let whole: Accumulator = values.iter().copied().collect();
        for split in [0, 1, 37, 100] {
            let mut left: Accumulator = values[..split].iter().copied().collect();
            left.merge(&values[split..].iter().copied().collect());
            assert_eq!(left.count(), whole.count());
            assert!((left.mean() - whole.mean()).abs() < 1e-10);
            assert!((left.variance() - whole.variance()).abs() < 1e-8);
        }
    }

    #[test]
    fn tests_accept_the_true_mean_and_reject_a_shift() {
        let mut random = TestRng::new(4);
        let sample: Accumulator = (0..10_000).map(|_| random.normal()).collect();
        let wider: Accumulator = (0..4_000).map(|_| 3.0 * random.normal()).collect();
        let shifted: Accumulator = (0..4_000).map(|_| 3.0 * random.normal() + 0.3).collect();
        let level = 1e-4;
        assert!(z_test(&sample, 0.0, 1.0).accepts(level));
        assert!(!z_test(&sample, 0.05, 1.0).accepts(level));
        assert!(t_test(&sample, 0.0).accepts(level));
        assert!(!t_test(&sample, 0.05).accepts(level));
        assert!(welch(&sample, &wider).accepts(level));
        assert!(!welch(&sample, &shifted).accepts(level));
    }

    #[test]
    fn p_values_are_uniform_under_the_hypothesis() {
        let mut random = TestRng::new(5);
        let mut bins = [0_u64; 10];
        for _ in 0..2000 {
            let sample: Accumulator = (0..5).map(|_| random.normal()).collect();
            bins[((t_test(&sample, 0.0).p_value * 10.0) as usize).min(9)] += 1;
        }
        crate::chi2_discrete(&bins, &[200.0; 10]).assert();
    }

    #[test]
    fn nan_and_zero_variance_are_decided() {
        let broken: Accumulator = [1.0, f64::NAN, 1.0].into_iter().collect();
        assert!(!t_test(&broken, 1.0).accepts(1e-9));
        let constant: Accumulator = [2.0; 5].into_iter().collect();
        assert!(t_test(&constant, 2.0).accepts(0.01));
        assert!(!t_test(&constant, 2.1).accepts(0.01));
    }
}
