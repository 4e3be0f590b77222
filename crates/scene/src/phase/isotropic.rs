//! `isotropic`: scattering without memory of where light came from.

use super::{PhaseFunction, PhaseSample};
use crate::builder::Builder;
use crate::manual::Manual;
use etendue_document::Parameters;
use etendue_sampling::warp;
use glam::Vec2;
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Scatters light evenly in all directions. Media without a phase function have this one.",
    parameters: &[],
    sample: r#"<phase type="isotropic"/>"#,
};

/// The density of every direction.
pub(super) const DENSITY: f32 = 0.25 / PI;

/// Reads the parameters: there are none.
#[must_use]
pub fn build(_builder: &mut Builder<'_>, _parameters: &Parameters<'_>) -> Option<PhaseFunction> {
    Some(PhaseFunction::Isotropic)
}

/// Any direction.
#[inline]
pub(super) fn sample(direction: Vec2) -> PhaseSample {
    PhaseSample { wo: warp::uniform_sphere::sample(direction), pdf: DENSITY }
}
