//! `gaussian`: the default filter, smooth and without ringing.

use super::{Profile, ReconstructionFilter};
use crate::manual::{Manual, parameter};
use etendue_document::Parameters;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A Gaussian, cut off at four standard deviations and lowered so that it ends at zero. \
              The default: smooth, never negative.",
    parameters: &[parameter("stddev", "float", "0.5", "The standard deviation, in pixels.")],
    sample: r#"<rfilter type="gaussian"><float name="stddev" value="0.45"/></rfilter>"#,
};

/// The radius in standard deviations.
const DEVIATIONS: f32 = 4.0;

/// exp(−x² / 2σ²) − exp(−8).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    deviation: f32,
}

impl Default for Gaussian {
    fn default() -> Self {
        Self { deviation: 0.5 }
    }
}

/// Reads the filter.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<ReconstructionFilter> {
    let range = *super::RADII.start()..=*super::RADII.end() / f64::from(DEVIATIONS);
    let deviation = parameters.float_in("stddev", 0.5, range) as f32;
    Some(ReconstructionFilter::new(Gaussian { deviation }.into()))
}

impl Gaussian {
    pub(super) fn radius(self) -> f32 {
        DEVIATIONS * self.deviation
    }

    pub(super) fn eval(self, distance: f32) -> f32 {
        let scaled = distance / self.deviation;
        ((-0.5 * scaled * scaled).exp() - (-0.5 * DEVIATIONS * DEVIATIONS).exp()).max(0.0)
    }
}

impl From<Gaussian> for Profile {
    fn from(filter: Gaussian) -> Self {
        Self::Gaussian(filter)
    }
}
