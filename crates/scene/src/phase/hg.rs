//! `hg`: the Henyey–Greenstein phase function.

#[cfg(test)]
use super::tests::Cases;
use super::{MediumInteraction, PhaseModel, PhaseSample, deflected, forwardness};
use crate::builder::Builder;
use crate::manual::{Manual, parameter};
use etendue_document::{Fault, Parameters};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The phase function of Henyey and Greenstein: from backward over even to forward \
              scattering, by one number.",
    parameters: &[parameter(
        "g",
        "float",
        "0.8",
        "The mean cosine of the scattering angle, between −1 and 1: positive scatters forward.",
    )],
    sample: r#"<phase type="hg"><float name="g" value="0.7"/></phase>"#,
};

/// The cases for the tests of all phase functions.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        r#"<phase type="hg"><float name="g" value="0"/></phase>"#,
        r#"<phase type="hg"><float name="g" value="0.0009"/></phase>"#,
        r#"<phase type="hg"><float name="g" value="0.85"/></phase>"#,
        r#"<phase type="hg"><float name="g" value="-0.6"/></phase>"#,
    ],
    extreme: &[
        r#"<phase type="hg"><float name="g" value="0.9999"/></phase>"#,
        r#"<phase type="hg"><float name="g" value="-0.9999"/></phase>"#,
        r#"<phase type="hg"><float name="g" value="1e-30"/></phase>"#,
    ],
};

/// Henyey and Greenstein, "Diffuse radiation in the galaxy", *Astrophysical Journal* 93, 1941.
#[derive(Clone, Copy, Debug)]
pub struct HenyeyGreenstein {
    g: f32,
}

/// Reads the parameters.
#[must_use]
pub fn build(_builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<HenyeyGreenstein> {
    let g = parameters.float("g", 0.8) as f32;
    if g.abs() < 1.0 {
        return Some(HenyeyGreenstein { g });
    }
    parameters.error(Fault::BadValue, "g", format!("`g` is {g}, but must be between −1 and 1"));
    None
}

impl PhaseModel for HenyeyGreenstein {
    #[inline]
    fn eval(&self, interaction: &MediumInteraction, wo: Vec3) -> f32 {
        self.density(forwardness(interaction, wo))
    }

    /// Inverts the distribution of the cosine.
    #[inline]
    fn sample(
        &self,
        interaction: &MediumInteraction,
        _part: f32,
        direction: Vec2,
    ) -> Option<PhaseSample> {
        let g = self.g;
        let cosine = if g.abs() < 1e-3 {
            // The closed form divides by g, so this is the inverse to first order in g.
            let even = 2.0 * direction.x - 1.0;
            even + 1.5 * g * (1.0 - even * even)
        } else {
            let ratio = (1.0 - g) * (1.0 + g) / (1.0 - g + 2.0 * g * direction.x);
            (1.0 + g * g - ratio * ratio) / (2.0 * g)
        };
        let cosine = cosine.clamp(-1.0, 1.0);
        let wo = deflected(interaction, cosine, direction.y);
        Some(PhaseSample { wo, pdf: self.density(cosine) })
    }
}

impl HenyeyGreenstein {
    /// The density of a direction, by the cosine of the scattering angle.
    #[inline]
    fn density(&self, cosine: f32) -> f32 {
        let g = self.g;
        // 1 + g² − 2 g cos θ as a sum without cancellation, which keeps the precision of peaks with
        // g near 1.
        let apart = 1.0 - g.abs();
        let square = apart * apart + 2.0 * (g.abs() - g * cosine).max(0.0);
        0.25 / PI * (1.0 - g) * (1.0 + g) / (square * square.sqrt())
    }
}
