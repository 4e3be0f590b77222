//! Pearson's test of counts, and its outcome.

use crate::rectangle::Rectangle;
use crate::special::chi_square_tail;
use glam::DVec2;
use std::fmt;

/// Cells that are expected to hold fewer samples are pooled, because χ² is an approximation for
/// large counts (Cochran, 1952).
pub(crate) const MIN_EXPECTED: f64 = 5.0;

/// Tests counts against expected counts (or anything proportional to them), at the significance
/// level 0.01.
#[must_use]
pub fn chi2_discrete(observed: &[u64], expected: &[f64]) -> ChiSquareOutcome {
    let total: f64 = expected.iter().sum();
    let fractions: Vec<f64> = expected.iter().map(|count| count / total).collect();
    let mut outcome = compare(observed, &fractions, 0.01);
    if let Some(&value) = expected.iter().find(|count| !(count.is_finite() && **count >= 0.0)) {
        outcome.rejection = Some(Rejection::BadDensity { point: DVec2::ZERO, value });
    } else if observed.len() != expected.len() {
        outcome.rejection = Some(Rejection::Shape);
    }
    outcome
}

/// The outcome of a χ² test.
#[derive(Clone, Debug, PartialEq)]
pub struct ChiSquareOutcome {
    /// Why the density is rejected, if it is.
    pub rejection: Option<Rejection>,
    /// Σ (observed − expected)² / expected over the pooled cells.
    pub statistic: f64,
    /// The number of pooled cells minus one.
    pub degrees_of_freedom: usize,
    /// The probability of a statistic at least as large, if the density is true.
    pub p_value: f64,
    /// The level below which the p-value rejects.
    pub level: f64,
    /// The fraction of samples that did not fail.
    pub success_rate: f64,
    /// The integral of the density over the whole domain.
    pub pdf_integral: f64,
    /// The cells, in the unit square that parametrises the domain; empty for discrete tests.
    pub cells: Vec<Rectangle>,
    /// The number of samples per cell.
    pub observed: Vec<u64>,
    /// The expected number of samples per cell, scaled to the same total.
    pub expected: Vec<f64>,
}

/// Why a χ² test rejects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rejection {
    /// The density is NaN, infinite or negative at a point of the parametrised domain.
    BadDensity {
        /// The point, in the unit square that parametrises the domain.
        point: DVec2,
        /// The density there.
        value: f64,
    },
    /// Samples are not finite or outside the domain.
    OutsideDomain {
        /// The number of such samples.
        count: u64,
    },
    /// The density of samples is zero or not finite.
    SampleWithoutDensity {
        /// The number of such samples.
        count: u64,
    },
    /// The integral of the density is not the fraction of successful samples, or exceeds one.
    Integral {
        /// The tolerated difference.
        allowed: f64,
    },
    /// There are too few cells after pooling.
    TooFewCells,
    /// The tables of observed and expected counts differ in length.
    Shape,
    /// The counts do not follow the density.
    Distribution,
}

impl ChiSquareOutcome {
    /// Whether the density is accepted.
    #[must_use]
    pub fn accepted(&self) -> bool {
        self.rejection.is_none()
    }

    /// Asserts that the density is accepted.
    ///
    /// # Panics
    /// With a report of the outcome if it is rejected.
    #[track_caller]
    pub fn assert(&self) {
        assert!(self.accepted(), "{self}");
    }
}

impl fmt::Display for ChiSquareOutcome {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.rejection {
            None => writeln!(formatter, "the density is accepted")?,
            Some(rejection) => writeln!(formatter, "the density is rejected: {rejection:?}")?,
        }
        writeln!(
            formatter,
            "chi² {:.2} at {} degrees of freedom, p {:.3e}, level {:.3e}",
            self.statistic, self.degrees_of_freedom, self.p_value, self.level
        )?;
        writeln!(
            formatter,
            "success rate {:.6}, integral of the density {:.6}",
            self.success_rate, self.pdf_integral
        )?;
        self.write_worst_cells(formatter)
    }
}

impl ChiSquareOutcome {
    /// Writes the ten cells that contribute most.
    fn write_worst_cells(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let contribution = |index: usize| {
            let expected = self.expected.get(index).copied().unwrap_or(0.0);
            (self.observed[index] as f64 - expected).powi(2) / expected.max(1.0)
        };
        let mut order: Vec<usize> = (0..self.observed.len()).collect();
        order.sort_by(|&a, &b| contribution(b).total_cmp(&contribution(a)));
        writeln!(formatter, "worst cells: observed, expected, rectangle")?;
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

/// Pearson's test of counts against expected fractions, conditional on the total count.
pub(crate) fn compare(observed: &[u64], fractions: &[f64], level: f64) -> ChiSquareOutcome {
    let total: u64 = observed.iter().sum();
    let sum: f64 = fractions.iter().sum();
    let scale = if sum > 0.0 { total as f64 / sum } else { 0.0 };
    let expected: Vec<f64> = fractions.iter().map(|fraction| fraction * scale).collect();
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
        // NaN is rejected, too.
        Some(Rejection::Distribution)
    };
    ChiSquareOutcome {
        rejection,
        statistic,
        degrees_of_freedom,
        p_value,
        level,
        success_rate: 1.0,
        pdf_integral: sum,
        cells: Vec::new(),
        observed: observed.to_vec(),
        expected,
    }
}

/// Sorts cells by their expectation, and merges small ones until each expects enough samples.
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
        // Only if the total expectation is too small or NaN.
        pooled.push(open);
    }
    pooled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discrete_counts_are_tested() {
        chi2_discrete(&[102, 95, 103], &[1.0, 1.0, 1.0]).assert();
        assert!(!chi2_discrete(&[150, 75, 75], &[1.0, 1.0, 1.0]).accepted());
        assert!(!chi2_discrete(&[100, 100, 50], &[1.0, 1.0, 0.0]).accepted());
        let single = chi2_discrete(&[100], &[1.0]);
        assert_eq!(single.rejection, Some(Rejection::TooFewCells));
        assert_eq!(chi2_discrete(&[1, 2], &[1.0]).rejection, Some(Rejection::Shape));
    }

    #[test]
    fn a_rejection_report_lists_the_cells() {
        let outcome = chi2_discrete(&[150, 75, 75], &[1.0, 1.0, 1.0]);
        let report = outcome.to_string();
        assert!(report.contains("Distribution") && report.contains("0: 150, 100.00"));
    }
}
