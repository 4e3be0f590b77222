//! `constant`: an environment of constant radiance.

use super::{
    DirectionSample, LaneEmitter, Light, RaySample, SAMPLING_WEIGHT, SceneView, Target,
    sample_ray_from_afar,
};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{LightLanes, TargetLanes};
use crate::manual::{Manual, parameter};
use crate::shape::Shape;
#[cfg(test)]
use crate::testing::emitter_cases::Cases;
use etendue_document::Parameters;
use etendue_math::lanes::{Real, Vector2, Vector3};
use etendue_sampling::warp;
use etendue_spectrum::{Spectrum, SpectrumLanes, SpectrumUse};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Surrounds the scene with the same radiance from all directions.",
    parameters: &[parameter("radiance", "spectrum", "1", "Radiance, W·m⁻²·sr⁻¹."), SAMPLING_WEIGHT],
    sample: r#"<emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>"#,
};

/// The cases for the tests of all emitters.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    hittable: &[
        r#"<emitter type="constant"/>"#,
    ],
    leaving: &[
        r#"<emitter type="constant"/>"#,
    ],
    extreme: &[
        r#"<emitter type="constant"><float name="radiance" value="0"/></emitter>"#,
    ],
};

/// A constant environment.
#[derive(Clone, Debug)]
pub struct Constant {
    radiance: Spectrum,
}

/// Reads a constant environment.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Constant> {
    Some(Constant {
        radiance: builder.constant_color(parameters, "radiance", 1.0, SpectrumUse::Emission),
    })
}

/// [`Light::sample_direction`] of [`Constant`] over any [`Real`].
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

impl Light for Constant {
    fn is_black(&self) -> bool {
        self.radiance.is_black()
    }

    fn is_environment(&self) -> bool {
        true
    }

    fn sample_direction(
        &self,
        _scene: &impl SceneView,
        _reference: Vec3,
        random: Vec2,
    ) -> Option<DirectionSample> {
        Some(DirectionSample {
            direction: warp::uniform_sphere::sample(random),
            radiance: self.radiance,
            pdf: DENSITY,
            delta: false,
            target: Target::Afar,
        })
    }

    fn pdf_direction(
        &self,
        _scene: &impl SceneView,
        _reference: Vec3,
        _direction: Vec3,
        _surface: Option<&SurfaceInteraction>,
    ) -> f32 {
        DENSITY
    }

    fn distant_radiance(&self, _direction: Vec3) -> Spectrum {
        self.radiance
    }

    fn sample_ray(
        &self,
        scene: &impl SceneView,
        place: Vec2,
        direction: Vec2,
    ) -> Option<RaySample> {
        sample_ray_from_afar(self, scene, place, direction)
    }

    fn in_lanes(&self, _shapes: &[Shape]) -> LaneEmitter {
        LaneEmitter::ConstantEnvironment(self.radiance)
    }
}
