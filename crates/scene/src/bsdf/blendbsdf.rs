//! `blendbsdf`: a mixture of two materials.

use super::{Bsdf, Gather, Placement, WrapperMaterial};
use crate::builder::Builder;
use crate::ids::MaterialId;
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::{fraction, limited, nested};
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, plain};
use crate::texture::ScalarSource;
use etendue_document::Parameters;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Mixes two materials, by a number or a texture.",
    parameters: &[
        parameter(
            "weight",
            "float or texture",
            "0.5",
            "The share of the second material: 0 is the first one alone, 1 the second.",
        ),
        parameter("(nested)", "bsdf", "", "The first material."),
        parameter("(nested)", "bsdf", "", "The second material."),
    ],
    sample: r#"<bsdf type="blendbsdf">
    <float name="weight" value="0.2"/>
    <bsdf type="diffuse"/>
    <bsdf type="roughconductor"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="blendbsdf"><float name="weight" value="0.6"/><bsdf type="plastic"/><bsdf type="roughdielectric"/></bsdf>"#),
        plain(r#"<bsdf type="blendbsdf"><float name="weight" value="0.3"/><bsdf type="diffuse"/><bsdf type="mask"><bsdf type="roughconductor"/></bsdf></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="blendbsdf"><float name="weight" value="1e-30"/><bsdf type="diffuse"/><bsdf type="roughconductor"><float name="alpha" value="0"/></bsdf></bsdf>"#,
    ],
    batched: &[],
};

/// A mixture of two materials.
#[derive(Clone, Copy, Debug)]
pub struct BlendBsdf {
    weight: ScalarSource,
    pub(crate) nested: [MaterialId; 2],
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<BlendBsdf> {
    let weight = fraction(builder, parameters, "weight", 0.5);
    let nested = nested(builder, parameters, 2..=2)?;
    Some(BlendBsdf { weight, nested: [nested[0], nested[1]] })
}

impl WrapperMaterial for BlendBsdf {
    fn transmits(&self, nested: &dyn Fn(MaterialId) -> bool) -> bool {
        self.nested.iter().any(|&id| nested(id))
    }

    /// Adds the closures of both materials with their weights.
    fn gather<'a>(&self, gather: &Gather<'a, '_>, placement: Placement, bsdf: &mut Bsdf<'a>) {
        let weight = limited(self.weight.eval(gather.textures, gather.surface), 0.0, 1.0);
        for (nested, share) in self.nested.into_iter().zip([1.0 - weight, weight]) {
            if share > 0.0 {
                gather.add(nested, placement.scaled(share), bsdf);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::material::{assert_finds, assert_same};
    use etendue_document::{Fault, Severity};

    #[test]
    fn the_ends_of_the_range_are_the_materials() {
        let blend = |weight: &str| {
            format!(
                r#"<bsdf type="blendbsdf"><float name="weight" value="{weight}"/>
                   <bsdf type="roughplastic"/><bsdf type="roughdielectric"/></bsdf>"#
            )
        };
        assert_same(&blend("0"), r#"<bsdf type="roughplastic"/>"#);
        assert_same(&blend("1"), r#"<bsdf type="roughdielectric"/>"#);
    }

    #[test]
    fn it_takes_two() {
        assert_finds(
            r#"<bsdf type="blendbsdf"><bsdf type="diffuse"/></bsdf>"#,
            Severity::Error,
            Fault::MissingParameter,
            "2 materials",
        );
    }
}
