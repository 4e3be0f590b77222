//! `isotropic`: equal scattering in all directions.

#[cfg(test)]
use super::tests::Cases;
use super::{MediumInteraction, PhaseModel, PhaseSample};
use crate::builder::Builder;
use crate::manual::Manual;
use etendue_document::Parameters;
use etendue_sampling::warp;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Scatters light evenly in all directions. Media without a phase function have this one.",
    parameters: &[],
    sample: r#"<phase type="isotropic"/>"#,
};

/// The cases for the tests of all phase functions.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        r#"<phase type="isotropic"/>"#,
    ],
    extreme: &[
        r#"<phase type="isotropic"/>"#,
    ],
};

/// The density of every direction.
const DENSITY: f32 = 0.25 / PI;

/// The same in all directions.
#[derive(Clone, Copy, Debug)]
pub struct Isotropic;

/// Reads the phase function, which has no parameters.
#[must_use]
pub fn build(_builder: &mut Builder<'_>, _parameters: &Parameters<'_>) -> Option<Isotropic> {
    Some(Isotropic)
}

impl PhaseModel for Isotropic {
    #[inline]
    fn eval(&self, _interaction: &MediumInteraction, _wo: Vec3) -> f32 {
        DENSITY
    }

    #[inline]
    fn sample(
        &self,
        _interaction: &MediumInteraction,
        _part: f32,
        direction: Vec2,
    ) -> Option<PhaseSample> {
        Some(PhaseSample { wo: warp::uniform_sphere::sample(direction), pdf: DENSITY })
    }
}
