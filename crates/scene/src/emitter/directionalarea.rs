//! `directionalarea`: a shape that emits only along its normals.

use super::area::ray_from_shape;
use super::{DirectionSample, Light, RaySample, SAMPLING_WEIGHT, SceneView};
use crate::builder::Builder;
use crate::ids::ShapeId;
use crate::manual::{Manual, parameter};
#[cfg(test)]
use crate::testing::emitter_cases::Cases;
use crate::texture::ColorSource;
use etendue_document::Parameters;
use etendue_spectrum::SpectrumUse;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Makes the shape that it is nested in a light whose every point shines along the surface's \
              normal alone. No path from the camera finds such light by chance, and none can aim for \
              it: only `ptracer` shows it.",
    parameters: &[
        parameter(
            "radiance",
            "spectrum or texture",
            "1",
            "Radiant exitance: power that leaves the surface per area, W·m⁻².",
        ),
        SAMPLING_WEIGHT,
    ],
    sample: r#"<shape type="rectangle"><emitter type="directionalarea"><rgb name="radiance" value="5, 4, 3"/></emitter></shape>"#,
};

/// The cases for the tests of all emitters.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    hittable: &[],
    leaving: &[],
    extreme: &[
        r#"<shape type="disk"><transform name="to_world"><scale value="1e10"/></transform><emitter type="directionalarea"/></shape>"#,
    ],
};

/// A shape that emits only along its normals.
#[derive(Clone, Debug)]
pub struct DirectionalArea {
    /// The shape.
    shape: ShapeId,
    /// Power per area.
    exitance: ColorSource,
}

/// Reads the emitter of `shape`.
#[must_use]
pub fn build(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    shape: ShapeId,
) -> DirectionalArea {
    let exitance = builder.color(parameters, "radiance", 1.0, SpectrumUse::Emission);
    DirectionalArea { shape, exitance }
}

impl Light for DirectionalArea {
    fn is_delta(&self) -> bool {
        true
    }

    fn is_black(&self) -> bool {
        self.exitance.is_black()
    }

    /// The probability that a point sees such light is zero.
    fn sample_direction(
        &self,
        _scene: &impl SceneView,
        _reference: Vec3,
        _random: Vec2,
    ) -> Option<DirectionSample> {
        None
    }

    fn sample_ray(
        &self,
        scene: &impl SceneView,
        place: Vec2,
        _direction: Vec2,
    ) -> Option<RaySample> {
        let sample = scene.shape(self.shape).sample_area(place)?;
        ray_from_shape(scene, (self.shape, &sample), self.exitance, (sample.shading_normal, 1.0))
    }
}
