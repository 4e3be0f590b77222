//! `constant`: the same light from everywhere afar.

use super::{DirectionSample, SAMPLING_WEIGHT, Target};
use crate::builder::Builder;
use crate::lanes::{LightLanes, TargetLanes};
use crate::manual::{Manual, parameter};
use etendue_document::Parameters;
use etendue_math::lanes::{Real, Vector2, Vector3};
use etendue_sampling::warp;
use etendue_spectrum::{Spectrum, SpectrumLanes, SpectrumUse};
use glam::Vec2;
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Surrounds the scene with the same radiance from all directions.",
    parameters: &[parameter("radiance", "spectrum", "1", "Radiance, W·m⁻²·sr⁻¹."), SAMPLING_WEIGHT],
    sample: r#"<emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>"#,
};

/// Uniform surroundings.
#[derive(Clone, Debug)]
pub struct Constant {
    radiance: Spectrum,
}

/// Reads uniform surroundings.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Constant> {
    Some(Constant {
        radiance: builder.constant_color(parameters, "radiance", 1.0, SpectrumUse::Emission),
    })
}

/// Light from everywhere, as [`Constant::sample_direction`] over any [`Real`].
#[inline(always)]
pub(crate) fn light_from_everywhere<R: Real>(
    radiance: SpectrumLanes<R>,
    random: Vector2<R>,
) -> LightLanes<R> {
    let zero = random.x.zero();
    let nowhere = Vector3::new(zero, zero, zero);
    let always = zero.equals(zero);
    LightLanes {
        direction: warp::uniform_sphere::sample_lanes(random),
        radiance,
        pdf: zero.like(DENSITY),
        delta: !always,
        exists: always,
        target: TargetLanes { point: nowhere, error: nowhere, normal: nowhere, afar: always },
    }
}

/// The density of every direction.
const DENSITY: f32 = 1.0 / (4.0 * PI);

impl Constant {
    pub(crate) fn radiance(&self) -> Spectrum {
        self.radiance
    }

    pub(crate) fn sample_direction(&self, random: Vec2) -> DirectionSample {
        DirectionSample {
            direction: warp::uniform_sphere::sample(random),
            radiance: self.radiance,
            pdf: self.pdf_direction(),
            delta: false,
            target: Target::Afar,
        }
    }

    pub(crate) fn pdf_direction(&self) -> f32 {
        DENSITY
    }
}
