//! `lanczos`: the windowed sinc, the sharpest filter and the one that rings most.

use super::{Profile, ReconstructionFilter};
use crate::manual::{Manual, parameter};
use etendue_document::Parameters;
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The sinc function within the central lobe of a wider sinc: nearest to the ideal \
              low-pass filter. Rings beside strong edges.",
    parameters: &[parameter(
        "lobes",
        "integer",
        "3",
        "How many lobes of the sinc are kept on each side; also the radius in pixels.",
    )],
    sample: r#"<rfilter type="lanczos"><integer name="lobes" value="2"/></rfilter>"#,
};

/// sinc(x)·sinc(x / lobes), where sinc(x) = sin(πx) / πx.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanczos {
    lobes: f32,
}

/// More lobes ring further without benefit, and the resolution of the filter's table is limited.
const MAX_LOBES: i64 = 16;

impl Default for Lanczos {
    fn default() -> Self {
        Self { lobes: 3.0 }
    }
}

/// Reads the filter.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<ReconstructionFilter> {
    let lobes = parameters.integer_in("lobes", 3, 1..=MAX_LOBES) as f32;
    Some(ReconstructionFilter::new(Lanczos { lobes }.into()))
}

impl Lanczos {
    pub(super) fn radius(self) -> f32 {
        self.lobes
    }

    pub(super) fn eval(self, distance: f32) -> f32 {
        sinc(distance) * sinc(distance / self.lobes)
    }
}

fn sinc(x: f32) -> f32 {
    let angle = PI * x;
    // Below this, the next term of the series, angle²/6, is smaller than rounding.
    if angle < 1e-4 { 1.0 } else { angle.sin() / angle }
}

impl From<Lanczos> for Profile {
    fn from(filter: Lanczos) -> Self {
        Self::Lanczos(filter)
    }
}
