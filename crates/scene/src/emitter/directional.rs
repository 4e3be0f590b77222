//! `directional`: parallel light from infinity.

use super::{DirectionSample, Light, RaySample, SAMPLING_WEIGHT, SceneView, Target, ray_from_afar};
use crate::builder::Builder;
use crate::inputs::transform::read_transform;
use crate::manual::{Manual, parameter};
#[cfg(test)]
use crate::testing::emitter_cases::Cases;
use etendue_document::{Fault, Parameters};
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::{DVec3, Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Parallel light that travels along `direction`, or along +z of `to_world`.",
    parameters: &[
        parameter(
            "irradiance",
            "spectrum",
            "1",
            "Irradiance on a surface that faces the light, W·m⁻².",
        ),
        parameter("direction", "vector", "", "Where the light travels to."),
        parameter(
            "to_world",
            "transform",
            "",
            "Its z axis is where the light travels to, unless `direction` is given.",
        ),
        SAMPLING_WEIGHT,
    ],
    sample: r#"<emitter type="directional"><vector name="direction" x="1" y="-2" z="0.5"/></emitter>"#,
};

/// The cases for the tests of all emitters.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    hittable: &[],
    leaving: &[
        r#"<emitter type="directional"><vector name="direction" x="0.2" y="0.1" z="-1"/></emitter>"#,
    ],
    extreme: &[
        r#"<emitter type="directional"><vector name="direction" x="1e-20" y="0" z="0"/></emitter>"#,
    ],
};

/// A directional light.
#[derive(Clone, Debug)]
pub struct Directional {
    /// The unit direction towards the light.
    towards_light: Vec3,
    irradiance: Spectrum,
}

/// Reads a directional light.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Directional> {
    let irradiance = builder.constant_color(parameters, "irradiance", 1.0, SpectrumUse::Emission);
    let axis = read_transform(parameters, "to_world")?.vector(Vec3::Z);
    let travels = parameters.optional_vector("direction").map_or(axis, |v: DVec3| v.as_vec3());
    let Some(direction) = travels.try_normalize() else {
        parameters.error(Fault::BadValue, "direction", "the direction has no length");
        return None;
    };
    Some(Directional { towards_light: -direction, irradiance })
}

impl Light for Directional {
    fn is_delta(&self) -> bool {
        true
    }

    fn is_black(&self) -> bool {
        self.irradiance.is_black()
    }

    fn sample_direction(
        &self,
        _scene: &impl SceneView,
        _reference: Vec3,
        _random: Vec2,
    ) -> Option<DirectionSample> {
        Some(DirectionSample {
            direction: self.towards_light,
            radiance: self.irradiance,
            pdf: 1.0,
            delta: true,
            target: Target::Afar,
        })
    }

    fn sample_ray(
        &self,
        scene: &impl SceneView,
        place: Vec2,
        _direction: Vec2,
    ) -> Option<RaySample> {
        ray_from_afar(scene, self.towards_light, self.irradiance, place)
    }
}
