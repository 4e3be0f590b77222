//! `spot`: a point light that emits into a cone.

use super::point::point_sample;
use super::{DirectionSample, Light, RaySample, SAMPLING_WEIGHT, SceneView};
use crate::builder::Builder;
use crate::inputs::transform::read_transform;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
#[cfg(test)]
use crate::testing::emitter_cases::Cases;
use crate::texture::{ColorSource, Textures};
use etendue_document::{Fault, Parameters};
use etendue_math::{Frame, Ray, Transform};
use etendue_sampling::warp;
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A point at the origin that shines along +z into a cone, with a linear falloff in angle \
              between `beam_width` and `cutoff_angle`; placed by `to_world`.",
    parameters: &[
        parameter("intensity", "spectrum", "1", "Radiant intensity within the beam, W·sr⁻¹."),
        parameter(
            "cutoff_angle",
            "float",
            "20",
            "Beyond this angle from the axis there is no light (degrees; up to 180).",
        ),
        parameter(
            "beam_width",
            "float",
            "",
            "Up to this angle there is all of it (degrees); ¾ of `cutoff_angle`.",
        ),
        parameter("texture", "texture", "", "A picture projected into the cone."),
        parameter("to_world", "transform", "", "Placement."),
        SAMPLING_WEIGHT,
    ],
    sample: r#"<emitter type="spot"><transform name="to_world"><lookat origin="0, 5, 0" target="0, 0, 0" up="0, 0, 1"/></transform><float name="cutoff_angle" value="30"/></emitter>"#,
};

/// The cases for the tests of all emitters.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    hittable: &[],
    leaving: &[
        r#"<emitter type="spot"><float name="cutoff_angle" value="25"/><texture name="texture" type="bitmap"><string name="filename" value="slide.exr"/></texture><transform name="to_world"><lookat origin="0.3, 0.5, 2" target="0.1, 0, -1" up="0, 1, 0"/></transform></emitter>"#,
    ],
    extreme: &[
        r#"<emitter type="spot"><float name="cutoff_angle" value="0.01"/><float name="beam_width" value="0"/></emitter>"#,
        r#"<emitter type="spot"><float name="cutoff_angle" value="89.99"/></emitter>"#,
        r#"<emitter type="spot"><float name="cutoff_angle" value="180"/></emitter>"#,
        r#"<emitter type="spot"><float name="cutoff_angle" value="10"/><float name="beam_width" value="90"/></emitter>"#,
    ],
};

/// A spot light. Angles are in radians.
#[derive(Clone, Debug)]
pub struct Spot {
    to_world: Transform,
    intensity: Spectrum,
    texture: ColorSource,
    cutoff_angle: f32,
    beam_width: f32,
}

/// Reads a spot light.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Spot> {
    let intensity = builder.constant_color(parameters, "intensity", 1.0, SpectrumUse::Emission);
    let texture = builder.color(parameters, "texture", 1.0, SpectrumUse::Unbounded);
    let cutoff_angle = parameters.float_in("cutoff_angle", 20.0, 1e-3..=MAX_ANGLE);
    let cutoff_angle = limit_picture(parameters, &texture, cutoff_angle);
    let beam_width = parameters.float_in("beam_width", 0.75 * cutoff_angle, 0.0..=MAX_ANGLE);
    if beam_width > cutoff_angle {
        let message = "the beam is wider than the cutoff angle: it ends there without a falloff";
        parameters.warning(Fault::BadValue, "beam_width", message);
    }
    Some(Spot {
        to_world: read_transform(parameters, "to_world")?,
        intensity,
        texture,
        cutoff_angle: cutoff_angle.to_radians() as f32,
        beam_width: beam_width.to_radians() as f32,
    })
}

/// A full circle. Angles of 180° and more are all around.
const MAX_ANGLE: f64 = 360.0;
/// The widest cone that a picture is projected into, in degrees.
const MAX_PICTURE_ANGLE: f64 = 89.0;

/// The cutoff angle of a light that may have a picture, which lies in a plane in front of it.
fn limit_picture(parameters: &Parameters<'_>, texture: &ColorSource, cutoff_angle: f64) -> f64 {
    if texture.is_constant() || cutoff_angle <= MAX_PICTURE_ANGLE {
        return cutoff_angle;
    }
    let message = format!(
        "a picture cannot fill a cone of {cutoff_angle}°: the cutoff angle is limited to \
         {MAX_PICTURE_ANGLE}°"
    );
    parameters.warning(Fault::Approximation, "cutoff_angle", message);
    MAX_PICTURE_ANGLE
}

impl Light for Spot {
    fn is_delta(&self) -> bool {
        true
    }

    fn is_black(&self) -> bool {
        self.intensity.is_black()
    }

    fn sample_direction(
        &self,
        scene: &impl SceneView,
        reference: Vec3,
        _random: Vec2,
    ) -> Option<DirectionSample> {
        let local = self.to_world.inverse_point(reference).try_normalize()?;
        let intensity = self.intensity_towards(scene.textures(), local);
        if intensity.is_black() {
            return None;
        }
        point_sample(self.to_world.point(Vec3::ZERO), intensity, reference)
    }

    fn sample_ray(
        &self,
        scene: &impl SceneView,
        _place: Vec2,
        direction: Vec2,
    ) -> Option<RaySample> {
        let cone = warp::uniform_cone::one_minus_cosine(self.cutoff_angle.min(PI));
        let local = warp::uniform_cone::sample(direction, cone);
        let intensity = self.intensity_towards(scene.textures(), local);
        let direction = self.to_world.vector(local).try_normalize()?;
        let origin = self.to_world.point(Vec3::ZERO);
        let power = intensity * (2.0 * PI * cone);
        (!power.is_black()).then_some(RaySample { ray: Ray::new(origin, direction), power })
    }
}

impl Spot {
    /// The intensity in a unit direction of the light's local space.
    fn intensity_towards(&self, textures: Textures<'_>, local: Vec3) -> Spectrum {
        let angle = local.truncate().length().atan2(local.z);
        if angle >= self.cutoff_angle {
            return Spectrum::ZERO;
        }
        let falloff = if angle <= self.beam_width {
            1.0
        } else {
            (self.cutoff_angle - angle) / (self.cutoff_angle - self.beam_width)
        };
        let texture = match self.texture {
            ColorSource::Constant(color) => color,
            ColorSource::Texture(id) => textures.eval(id, &self.picture_point(local)),
        };
        self.intensity * texture * falloff
    }

    /// The texture coordinates of a direction. The texture spans the cone.
    fn picture_point(&self, local: Vec3) -> SurfaceInteraction {
        let uv = local.truncate() / (local.z * self.cutoff_angle.tan()) * 0.5 + 0.5;
        SurfaceInteraction::at_uv(Vec2::new(uv.x, uv.y), Frame::from_normal(Vec3::Z))
    }
}
