//! `point`: a point light that emits in all directions.

use super::{DirectionSample, Light, RaySample, SAMPLING_WEIGHT, SceneView, Target};
use crate::builder::Builder;
use crate::inputs::transform::read_transform;
use crate::manual::{Manual, parameter};
#[cfg(test)]
use crate::testing::emitter_cases::Cases;
use etendue_document::Parameters;
use etendue_math::Ray;
use etendue_sampling::warp;
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A point that shines the same in all directions.",
    parameters: &[
        parameter("intensity", "spectrum", "1", "Radiant intensity, W·sr⁻¹."),
        parameter("position", "point", "0, 0, 0", "Where it is; `to_world` may say so instead."),
        parameter("to_world", "transform", "", "Placement of the origin."),
        SAMPLING_WEIGHT,
    ],
    sample: r#"<emitter type="point"><point name="position" x="0" y="5" z="0"/><rgb name="intensity" value="10"/></emitter>"#,
};

/// The cases for the tests of all emitters.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    hittable: &[],
    leaving: &[
        r#"<emitter type="point"><point name="position" x="0.3" y="0.2" z="1"/></emitter>"#,
    ],
    extreme: &[
        r#"<emitter type="point"><float name="intensity" value="1e30"/></emitter>"#,
    ],
};

/// A point light.
#[derive(Clone, Debug)]
pub struct Point {
    position: Vec3,
    intensity: Spectrum,
}

/// Reads a point light.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Point> {
    let intensity = builder.constant_color(parameters, "intensity", 1.0, SpectrumUse::Emission);
    let origin = read_transform(parameters, "to_world")?.point(Vec3::ZERO);
    let position = match parameters.has("position") {
        true => parameters.point("position", DVec3::ZERO).as_vec3(),
        false => origin,
    };
    Some(Point { position, intensity })
}

impl Light for Point {
    fn is_delta(&self) -> bool {
        true
    }

    fn is_black(&self) -> bool {
        self.intensity.is_black()
    }

    fn sample_direction(
        &self,
        _scene: &impl SceneView,
        reference: Vec3,
        _random: Vec2,
    ) -> Option<DirectionSample> {
        point_sample(self.position, self.intensity, reference)
    }

    fn sample_ray(
        &self,
        _scene: &impl SceneView,
        _place: Vec2,
        direction: Vec2,
    ) -> Option<RaySample> {
        let direction = warp::uniform_sphere::sample(direction);
        let ray = Ray::new(self.position, direction);
        Some(RaySample { ray, power: self.intensity * (4.0 * PI) })
    }
}

/// The light of a point with the given intensity towards `reference`.
pub(super) fn point_sample(
    position: Vec3,
    intensity: Spectrum,
    reference: Vec3,
) -> Option<DirectionSample> {
    let path = position - reference;
    let distance_squared = path.length_squared();
    let direction = path.try_normalize()?;
    Some(DirectionSample {
        direction,
        radiance: intensity / distance_squared,
        pdf: 1.0,
        delta: true,
        target: Target::Point { point: position, error: Vec3::ZERO, normal: Vec3::ZERO },
    })
}
