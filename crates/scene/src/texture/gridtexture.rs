//! `gridtexture`: lines along the edges of squares, from Mitsuba 0.6.

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
    summary: "A grid of lines: one along every edge of the unit squares of texture coordinates. \
              From Mitsuba 0.6.",
    parameters: &[
        parameter("color0", "spectrum or texture", "0.2", "The colour between the lines."),
        parameter("color1", "spectrum or texture", "0.4", "The colour of the lines."),
        parameter(
            "line_width",
            "float",
            "0.01",
            "How far a line reaches to each side, in texture coordinates.",
        ),
        parameter("to_uv", "transform", "", "Applied to texture coordinates; a scale repeats."),
    ],
    sample: r#"<texture type="gridtexture">
    <rgb name="color0" value="0.8, 0.8, 0.8"/>
    <rgb name="color1" value="0.1, 0.1, 0.1"/>
    <float name="line_width" value="0.03"/>
    <transform name="to_uv"><scale x="8" y="8"/></transform>
</texture>"#,
};

/// A grid of lines.
#[derive(Clone, Copy, Debug)]
pub struct GridTexture {
    background: ColorSource,
    lines: ColorSource,
    width: f32,
    to_uv: Affine2,
}

/// Reads the texture.
#[must_use]
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<GridTexture> {
    Some(GridTexture {
        background: builder.color(parameters, "color0", 0.2, SpectrumUse::Reflectance),
        lines: builder.color(parameters, "color1", 0.4, SpectrumUse::Reflectance),
        width: parameters.float_in("line_width", 0.01, 0.0..=1e6) as f32,
        to_uv: read_to_uv(parameters)?,
    })
}

impl TextureModel for GridTexture {
    fn eval(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum {
        self.eval(textures, surface)
    }

    fn mean(&self, textures: Textures<'_>) -> Spectrum {
        self.mean(textures)
    }
}

impl GridTexture {
    /// The colour at a surface point.
    #[must_use]
    pub fn eval(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> Spectrum {
        let on_line = self.is_line(self.to_uv.transform_point2(surface.uv));
        let color = if on_line { &self.lines } else { &self.background };
        color.eval(textures, surface)
    }

    fn is_line(&self, uv: Vec2) -> bool {
        let to_edge = (uv - uv.round()).abs();
        to_edge.min_element() < self.width
    }

    /// The mean colour over a unit square.
    #[must_use]
    pub fn mean(&self, textures: Textures<'_>) -> Spectrum {
        let between = (1.0 - 2.0 * self.width).max(0.0);
        self.lines.mean(textures).lerp(self.background.mean(textures), between * between)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::node::TestNode;
    use etendue_document::Class;
    use etendue_math::Frame;
    use glam::Vec3;

    #[test]
    fn lines_lie_on_both_sides_of_the_edges() {
        let node = TestNode::new(Class::Texture, "gridtexture").float("line_width", 0.1);
        let grid = node.build_cleanly(build);
        let frame = Frame::from_normal(Vec3::Z);
        let at = |u, v| {
            let surface = SurfaceInteraction::at_uv(Vec2::new(u, v), frame);
            grid.eval(Textures(&[]), &surface).luminance()
        };
        for (u, v) in [(0.05, 0.5), (0.95, 0.5), (0.5, -0.05), (3.5, 7.05)] {
            assert!((at(u, v) - 0.4).abs() < 1e-6, "({u}, {v})");
        }
        for (u, v) in [(0.15, 0.5), (0.5, 0.85), (-2.5, 0.5)] {
            assert!((at(u, v) - 0.2).abs() < 1e-6, "({u}, {v})");
        }
        assert!((grid.mean(Textures(&[])).luminance() - (0.64 * 0.2 + 0.36 * 0.4)).abs() < 1e-6);
    }
}
