//! `rayleigh`: scattering by particles much smaller than the wavelength.

#[cfg(test)]
use super::tests::Cases;
use super::{MediumInteraction, PhaseModel, PhaseSample, deflected, forwardness};
use crate::builder::Builder;
use crate::manual::Manual;
use etendue_document::Parameters;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Scatters light as particles much smaller than its wavelength do, such as the molecules \
              of air; polarisation is left out.",
    parameters: &[],
    sample: r#"<phase type="rayleigh"/>"#,
};

/// The cases for the tests of all phase functions.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        r#"<phase type="rayleigh"/>"#,
    ],
    extreme: &[
        r#"<phase type="rayleigh"/>"#,
    ],
};

/// Rayleigh scattering, by particles much smaller than the wavelength.
#[derive(Clone, Copy, Debug)]
pub struct Rayleigh;

/// Reads the phase function, which has no parameters.
#[must_use]
pub fn build(_builder: &mut Builder<'_>, _parameters: &Parameters<'_>) -> Option<Rayleigh> {
    Some(Rayleigh)
}

/// The density of a direction, by the cosine of the scattering angle: 3 (1 + cos² θ) / 16π.
#[inline]
fn density(cosine: f32) -> f32 {
    3.0 / (16.0 * PI) * (1.0 + cosine * cosine)
}

impl PhaseModel for Rayleigh {
    #[inline]
    fn eval(&self, interaction: &MediumInteraction, wo: Vec3) -> f32 {
        density(forwardness(interaction, wo))
    }

    /// Inverts the distribution of the cosine. It is a cubic in c = cos θ, c³ + 3 c = 4 (2 u − 1),
    /// solved by Cardano's formula (Frisvad, "Importance sampling the Rayleigh phase function",
    /// *JOSA A* 28(12), 2011).
    #[inline]
    fn sample(
        &self,
        interaction: &MediumInteraction,
        _part: f32,
        direction: Vec2,
    ) -> Option<PhaseSample> {
        let half = 2.0 * (2.0 * direction.x - 1.0);
        // The root with the sum does not cancel; the other is −1 divided by it.
        let root = (half.abs() + (half * half + 1.0).sqrt()).cbrt();
        let cosine = (root - root.recip()).copysign(half).clamp(-1.0, 1.0);
        let wo = deflected(interaction, cosine, direction.y);
        Some(PhaseSample { wo, pdf: density(cosine) })
    }
}
