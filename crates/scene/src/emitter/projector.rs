//! `projector`: a point that projects an image.

use super::point::point_sample;
use super::{DirectionSample, Light, RaySample, SAMPLING_WEIGHT, SceneView};
use crate::builder::Builder;
use crate::inputs::field_of_view::{FOCAL_LENGTH, FOV, FOV_AXIS, read_half_size};
use crate::inputs::transform::read_transform;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
#[cfg(test)]
use crate::testing::emitter_cases::Cases;
use crate::texture::{ColorSource, Texture, Textures};
use etendue_document::Parameters;
use etendue_math::{Frame, Ray, Transform};
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A slide projector: the reverse of a pinhole camera. It stands at the origin of its own \
              space and projects a picture along +z, with +y up; the picture's own shape is that of the \
              beam.",
    parameters: &[
        parameter(
            "irradiance",
            "spectrum or texture",
            "1",
            "The picture: what a white screen at distance one shows, W·m⁻²·sr⁻¹. As in Mitsuba, whose \
             page calls it irradiance, that is the irradiance over π.",
        ),
        parameter("scale", "float", "1", "A factor on it."),
        parameter("to_world", "transform", "", "Placement, usually a `lookat`."),
        FOV,
        FOV_AXIS,
        FOCAL_LENGTH,
        SAMPLING_WEIGHT,
    ],
    sample: r#"<emitter type="projector">
    <texture name="irradiance" type="bitmap"><string name="filename" value="wood.png"/></texture>
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 5, 0" target="0, 0, 0" up="0, 0, 1"/></transform>
</emitter>"#,
};

/// The cases for the tests of all emitters.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    hittable: &[],
    leaving: &[
        r#"<emitter type="projector"><texture name="irradiance" type="bitmap"><string name="filename" value="slide.exr"/></texture><float name="fov" value="40"/><transform name="to_world"><lookat origin="0.3, 0.5, 2" target="0.1, 0, -1" up="0, 1, 0"/></transform></emitter>"#,
    ],
    extreme: &[
        r#"<emitter type="projector"><float name="fov" value="179"/><float name="irradiance" value="1e20"/></emitter>"#,
    ],
};

/// A slide projector.
#[derive(Clone, Debug)]
pub struct Projector {
    to_world: Transform,
    irradiance: ColorSource,
    scale: f32,
    /// Half the width and height of the image at distance one.
    half_size: Vec2,
}

/// Reads a projector.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Projector> {
    let irradiance = builder.color(parameters, "irradiance", 1.0, SpectrumUse::Emission);
    let [width, height] = match irradiance {
        ColorSource::Constant(_) => [1, 1],
        ColorSource::Texture(id) => match &builder.textures[id.index()] {
            Texture::Bitmap(picture) => picture.resolution(),
            _ => [1, 1],
        },
    };
    let half_size = read_half_size(parameters, f64::from(width) / f64::from(height));
    let scale = parameters.float_in("scale", 1.0, 0.0..=f64::from(f32::MAX)) as f32;
    let to_world = read_transform(parameters, "to_world")?;
    Some(Projector { to_world, irradiance, scale, half_size: half_size?.as_vec2() })
}

impl Light for Projector {
    fn is_delta(&self) -> bool {
        true
    }

    fn is_black(&self) -> bool {
        self.scale == 0.0 || self.irradiance.is_black()
    }

    fn sample_direction(
        &self,
        scene: &impl SceneView,
        reference: Vec3,
        _random: Vec2,
    ) -> Option<DirectionSample> {
        let local = self.to_world.inverse_point(reference).try_normalize()?;
        let place = self.place(local)?;
        let intensity = self.picture(scene.textures(), place) / local.z.powi(3);
        if intensity.is_black() {
            return None;
        }
        point_sample(self.to_world.point(Vec3::ZERO), intensity, reference)
    }

    /// Image positions are uniform. With the area A of the image at distance one, their density in
    /// solid angle is 1/(A cos³θ), and the intensity is E/cos³θ. The quotient is E·A.
    fn sample_ray(
        &self,
        scene: &impl SceneView,
        _place: Vec2,
        direction: Vec2,
    ) -> Option<RaySample> {
        let local = ((1.0 - 2.0 * direction) * self.half_size).extend(1.0);
        let world = self.to_world.vector(local).try_normalize()?;
        let area = 4.0 * self.half_size.x * self.half_size.y;
        let power = self.picture(scene.textures(), direction) * area;
        let origin = self.to_world.point(Vec3::ZERO);
        (!power.is_black()).then_some(RaySample { ray: Ray::new(origin, world), power })
    }
}

impl Projector {
    /// The image position of a unit direction in projector space, if it lies inside the image.
    ///
    /// A screen at distance z has irradiance E/z². At an angle θ from the axis it is tilted by θ
    /// and at distance r = z/cosθ, so the intensity is E r²/(z² cosθ) = E/cos³θ.
    fn place(&self, local: Vec3) -> Option<Vec2> {
        let place = 0.5 - local.truncate() / (local.z * self.half_size) * 0.5;
        let inside = place.cmpge(Vec2::ZERO).all() && place.cmple(Vec2::ONE).all();
        (local.z > 0.0 && inside).then_some(place)
    }

    /// The irradiance at distance one. A white diffuse screen reflects 1/π of it.
    fn picture(&self, textures: Textures<'_>, place: Vec2) -> Spectrum {
        let surface = SurfaceInteraction::at_uv(place, Frame::from_normal(Vec3::Z));
        self.irradiance.eval(textures, &surface) * (self.scale * PI)
    }
}
