//! `checkerboard`: squares in two colours.

use super::{ColorSource, TextureModel, Textures};
use crate::builder::Builder;
use crate::inputs::uv::read_to_uv;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use etendue_document::Parameters;
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::{Affine2, Vec2};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A checkerboard: the unit square of texture coordinates holds two squares by two. Where a \
              number is asked for, such as a roughness, the two are the other way round, as in Mitsuba.",
    parameters: &[
        parameter(
            "color0",
            "spectrum or texture",
            "0.4",
            "The colour of the square that holds (0, 0).",
        ),
        parameter(
            "color1",
            "spectrum or texture",
            "0.2",
            "The other colour, where one of u and v is in the upper half of its interval.",
        ),
        parameter("to_uv", "transform", "", "Applied to texture coordinates; a scale repeats."),
    ],
    sample: r#"<texture type="checkerboard">
    <rgb name="color0" value="0.8, 0.8, 0.8"/>
    <rgb name="color1" value="0.1, 0.1, 0.1"/>
    <transform name="to_uv"><scale x="8" y="8"/></transform>
</texture>"#,
};

/// Squares in two colours.
#[derive(Clone, Copy, Debug)]
pub struct Checkerboard {
    colors: [ColorSource; 2],
    to_uv: Affine2,
}

/// Reads the texture.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Checkerboard> {
    let colors = [
        builder.color(parameters, "color0", 0.4, SpectrumUse::Reflectance),
        builder.color(parameters, "color1", 0.2, SpectrumUse::Reflectance),
    ];
    Some(Checkerboard { colors, to_uv: read_to_uv(parameters)? })
}

impl TextureModel for Checkerboard {
    fn eval(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum {
        self.eval(textures, surface)
    }

    fn eval_scalar(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> f32 {
        self.eval_scalar(textures, surface)
    }

    fn mean(&self, textures: Textures<'_>) -> Spectrum {
        self.mean(textures)
    }
}

impl Checkerboard {
    /// The colour at a surface point.
    #[must_use]
    pub fn eval(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum {
        let uv = self.to_uv.transform_point2(surface.uv);
        self.colors[square(uv)].eval(textures, surface)
    }

    /// The scalar at a surface point, which is that of the *other* colour. For scalars, Mitsuba
    /// 3.9.1 swaps the squares, and its reference images depend on it.
    #[must_use]
    pub fn eval_scalar(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> f32 {
        let uv = self.to_uv.transform_point2(surface.uv);
        self.colors[1 - square(uv)].eval(textures, surface).luminance()
    }

    /// The mean colour over the unit square of `uv`, as if `to_uv` covered whole squares.
    #[must_use]
    pub fn mean(&self, textures: Textures<'_>) -> Spectrum {
        (self.colors[0].mean(textures) + self.colors[1].mean(textures)) * 0.5
    }
}

/// The index of the colour at a point.
fn square(uv: Vec2) -> usize {
    let place = uv - uv.floor();
    usize::from((place.x > 0.5) != (place.y > 0.5))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::{Class, Value};
    use etendue_math::Frame;
    use glam::{DMat4, DVec3, Vec3};

    /// Taken from Mitsuba 3.9.1.
    #[test]
    fn squares_are_where_mitsuba_has_them() {
        let cases = [
            ((0.25, 0.25), 0),
            ((0.75, 0.25), 1),
            ((0.25, 0.75), 1),
            ((0.75, 0.75), 0),
            ((-0.25, 0.25), 1),
            ((-0.25, -0.25), 0),
            ((0.0, 0.0), 0),
            ((0.5, 0.5), 0),
            ((0.5, 0.25), 0),
            ((1.25, 0.25), 0),
        ];
        for ((u, v), expected) in cases {
            assert_eq!(square(Vec2::new(u, v)), expected, "({u}, {v})");
        }
    }

    #[test]
    fn coordinates_that_are_no_numbers_do_no_harm() {
        for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX] {
            assert!(square(Vec2::new(bad, 0.2)) < 2);
        }
    }

    #[test]
    fn colors_are_read_and_repeated_by_the_transform() {
        let scale = DMat4::from_scale(DVec3::new(2.0, 4.0, 1.0));
        let node = TestNode::new(Class::Texture, "checkerboard").float("color0", 0.9);
        let node = node.with("to_uv", Value::transform(scale));
        let texture = node.build_cleanly(build);
        let none = Textures(&[]);
        let at = |u, v| {
            let frame = Frame::from_normal(Vec3::Z);
            texture.eval(none, &SurfaceInteraction::at_uv(Vec2::new(u, v), frame)).rgb()
        };
        assert_eq!((at(0.1, 0.1), at(0.1, 0.2)), ([0.9; 3], [0.2; 3]), "as in Mitsuba");
        assert_eq!((at(0.25, 0.25), at(0.3, 0.25)), ([0.9; 3], [0.2; 3]));
        assert!((texture.mean(none).luminance() - 0.55).abs() < 1e-6);
        let surface = SurfaceInteraction::at_uv(Vec2::splat(0.1), Frame::from_normal(Vec3::Z));
        assert!((texture.eval_scalar(none, &surface) - 0.2).abs() < 1e-6, "as in Mitsuba");
    }
}
