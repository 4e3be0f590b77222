//! `mask`: a material with holes.

use super::{Bsdf, Gather, Placement, WrapperMaterial};
use crate::builder::Builder;
use crate::ids::MaterialId;
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::{fraction, limited, nested};
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, lossless, plain};
use crate::texture::{ScalarSource, Textures};
use etendue_document::{Fault, Parameters, Value};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Cuts holes into a material, or makes it see-through: where the opacity is 0, light \
              goes straight on; where it is 1, there is the nested material.",
    parameters: &[
        parameter("opacity", "float or texture", "0.5", "From 0 (nothing there) to 1 (opaque)."),
        parameter("(nested)", "bsdf", "", "The material."),
    ],
    sample: r#"<bsdf type="mask">
    <float name="opacity" value="0.3"/>
    <bsdf type="diffuse"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="mask"><float name="opacity" value="0.3"/><bsdf type="roughplastic"/></bsdf>"#),
        lossless(r#"<bsdf type="mask"><float name="opacity" value="0.3"/><bsdf type="twosided"><bsdf type="conductor"/></bsdf></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="mask"><float name="opacity" value="1e-30"/><bsdf type="roughplastic"/></bsdf>"#,
        r#"<bsdf type="mask"><float name="opacity" value="0"/><bsdf type="diffuse"/></bsdf>"#,
    ],
    batched: &[],
};

/// A material with an opacity.
#[derive(Clone, Copy, Debug)]
pub struct Mask {
    opacity: ScalarSource,
    nested: MaterialId,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Mask> {
    let opacity = fraction(builder, parameters, "opacity", 0.5);
    warn_of_color(builder, parameters, opacity);
    let nested = nested(builder, parameters, 1..=1)?[0];
    Some(Mask { opacity, nested })
}

/// The difference between two channels of an opacity that is still grey.
const GREY: f32 = 1e-3;

/// Warns of an opacity with a colour, whose channels would let through different light.
fn warn_of_color(builder: &Builder<'_>, parameters: &Parameters<'_>, opacity: ScalarSource) {
    let color = match (opacity, parameters.value("opacity")) {
        (ScalarSource::Texture(id), _) => Textures(&builder.textures).mean(id).rgb(),
        (_, Some((Value::Rgb(color), _))) => color.as_vec3().to_array(),
        _ => return,
    };
    let [low, high] = [f32::min, f32::max].map(|pick| color.into_iter().reduce(pick));
    if high > low.map(|low| low + GREY) {
        let message = "this opacity has a colour: its luminance counts, for all channels alike";
        parameters.warning(Fault::Approximation, "opacity", message);
    }
}

impl WrapperMaterial for Mask {
    fn transmits(&self, _nested: &dyn Fn(MaterialId) -> bool) -> bool {
        true
    }

    /// Adds the nested closures, and null transmission for the uncovered fraction.
    fn gather<'a>(&self, gather: &Gather<'a, '_>, placement: Placement, bsdf: &mut Bsdf<'a>) {
        let opacity = limited(self.opacity.eval(gather.textures, gather.surface), 0.0, 1.0);
        if opacity > 0.0 {
            gather.add(self.nested, placement.scaled(opacity), bsdf);
        }
        bsdf.push_null(placement.scaled(1.0 - opacity));
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::Transport;
    use crate::testing::material::{TestMaterial, assert_finds, assert_same};
    use crate::texture::Texture;
    use etendue_document::{Fault, Severity};
    use etendue_spectrum::Spectrum;
    use glam::Vec3;

    #[test]
    fn the_ends_of_the_range_are_the_material_and_nothing() {
        let mask = |opacity: &str| {
            format!(
                r#"<bsdf type="mask"><float name="opacity" value="{opacity}"/>
                   <bsdf type="roughplastic"/></bsdf>"#
            )
        };
        assert_same(&mask("1"), r#"<bsdf type="roughplastic"/>"#);
        assert_same(&mask("0"), r#"<bsdf type="null"/>"#);
    }

    #[test]
    fn opacities_out_of_range_are_limited() {
        for value in ["1.5", "-0.1", "1e39"] {
            assert_finds(
                &format!(
                    r#"<bsdf type="mask"><float name="opacity" value="{value}"/>
                       <bsdf type="diffuse"/></bsdf>"#
                ),
                Severity::Warning,
                Fault::BadValue,
                "opacity",
            );
        }
        let mut material = TestMaterial::read(
            r#"<bsdf type="mask"><texture name="opacity" type="checkerboard"/><bsdf type="diffuse"/></bsdf>"#,
        );
        for (texel, expected) in [(f32::NAN, 0.0), (-2.0, 0.0), (7.0, std::f32::consts::FRAC_1_PI)]
        {
            material.textures = vec![Texture::Constant(Spectrum::splat(texel))];
            let (_, pdf) = material.bsdf(Vec3::Z).eval_pdf(Vec3::Z, Vec3::Z, Transport::Radiance);
            assert!((pdf - expected).abs() < 1e-6, "{texel}: {pdf}");
        }
    }
}
