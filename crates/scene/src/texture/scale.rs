//! `scale`: another texture multiplied by a colour, from Mitsuba 0.6.

use super::{TextureModel, Textures};
use crate::builder::Builder;
use crate::ids::TextureId;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use etendue_document::{Class, Parameters};
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::Vec2;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Another texture, multiplied by a number or a colour. From Mitsuba 0.6, where height \
              maps are made higher by it.",
    parameters: &[
        parameter("(nested)", "texture", "", "The texture; any name will do."),
        parameter("scale", "spectrum", "1", "The factor."),
    ],
    sample: r#"<texture type="scale">
    <float name="scale" value="0.5"/>
    <texture type="checkerboard"/>
</texture>"#,
};

/// Another texture multiplied by a colour.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    nested: TextureId,
    factor: Spectrum,
}

/// Reads the texture.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Scale> {
    let factor = builder.constant_color(parameters, "scale", 1.0, SpectrumUse::Unbounded);
    let nested = parameters.required_child(Class::Texture)?;
    Some(Scale { nested: builder.texture(nested.node)?, factor })
}

impl TextureModel for Scale {
    fn eval(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum {
        self.eval(textures, surface)
    }

    fn eval_scalar(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> f32 {
        self.eval_scalar(textures, surface)
    }

    fn gradient(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Vec2 {
        self.gradient(textures, surface)
    }

    fn mean(&self, textures: Textures<'_>) -> Spectrum {
        self.mean(textures)
    }
}

impl Scale {
    /// The colour at a surface point.
    #[must_use]
    pub fn eval(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum {
        textures.eval(self.nested, surface) * self.factor
    }

    /// The scalar at a surface point.
    #[must_use]
    pub fn eval_scalar(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> f32 {
        textures.eval_scalar(self.nested, surface) * self.factor.luminance()
    }

    /// The derivatives of the luminance by u and v.
    #[must_use]
    pub fn gradient(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Vec2 {
        textures.gradient(self.nested, surface) * self.factor.luminance()
    }

    /// The mean colour over the unit square of `uv`.
    #[must_use]
    pub fn mean(&self, textures: Textures<'_>) -> Spectrum {
        textures.mean(self.nested) * self.factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Texture;
    use etendue_math::Frame;
    use glam::Vec3;

    #[test]
    fn the_factor_counts_for_values_and_means() {
        let nested = Texture::Constant(Spectrum::from_rgb([0.5, 1.0, 2.0]));
        let factor = Spectrum::from_rgb([2.0, 0.5, 1.0]);
        let all = [nested, Texture::Scale(Scale { nested: TextureId(0), factor })];
        let (textures, scale) = (Textures(&all), TextureId(1));
        let surface = SurfaceInteraction::at_uv(Vec2::ZERO, Frame::from_normal(Vec3::Z));
        let expected = Spectrum::from_rgb([1.0, 0.5, 2.0]);
        assert_eq!(textures.eval(scale, &surface), expected);
        let scalar = textures.eval_scalar(TextureId(0), &surface) * factor.luminance();
        assert_eq!(textures.eval_scalar(scale, &surface), scalar);
        assert_eq!(textures.mean(scale), expected);
    }
}
