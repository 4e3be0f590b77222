//! `twosided`: a material on both sides of a surface.

use super::{Bsdf, Gather, Placement, WrapperMaterial, transmits};
use crate::builder::Builder;
use crate::ids::MaterialId;
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::nested;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, one_way, plain};
use etendue_document::{Fault, Parameters};
use glam::Vec3;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Makes a material that is black from behind look the same from both sides, or gives \
              each side its own. Materials that let light through cannot be nested.",
    parameters: &[
        parameter("(nested)", "bsdf", "", "The material of both sides, or of the front."),
        parameter("(nested)", "bsdf", "", "The material of the back, where there is a second one."),
    ],
    sample: r#"<bsdf type="twosided">
    <bsdf type="diffuse">
        <rgb name="reflectance" value="0.4, 0.4, 0.4"/>
    </bsdf>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="twosided"><bsdf type="roughconductor"><string name="distribution" value="ggx"/></bsdf><bsdf type="diffuse"/></bsdf>"#),
        one_way(r#"<bsdf type="twosided"><bsdf type="normalmap"><rgb name="normalmap" value="0.3, 0.4, 0.9"/><bsdf type="diffuse"/></bsdf></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="twosided"><bsdf type="roughconductor"><float name="alpha" value="0"/></bsdf></bsdf>"#,
    ],
    batched: &[],
};

/// One material per side.
#[derive(Clone, Copy, Debug)]
pub struct TwoSided {
    front: MaterialId,
    back: MaterialId,
}

/// Reads the nested materials.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<TwoSided> {
    let nested = nested(builder, parameters, 1..=2)?;
    if nested.iter().any(|&id| transmits(&builder.materials, id)) {
        let message =
            "a material that lets light through has two sides already, and cannot be nested";
        parameters.diagnostics().error(Fault::BadValue, parameters.span(), message);
        return None;
    }
    Some(TwoSided { front: nested[0], back: nested[nested.len() - 1] })
}

impl WrapperMaterial for TwoSided {
    fn transmits(&self, _nested: &dyn Fn(MaterialId) -> bool) -> bool {
        false
    }

    /// Adds the closures of the side that `wi` is on.
    fn gather<'a>(&self, gather: &Gather<'a, '_>, placement: Placement, bsdf: &mut Bsdf<'a>) {
        let (material, placement) = self.side(placement, gather.surface.wi);
        gather.add(material, placement, bsdf);
    }
}

impl TwoSided {
    /// The material of both sides, if they share one.
    #[must_use]
    pub fn both(&self) -> Option<MaterialId> {
        (self.front == self.back).then_some(self.front)
    }

    /// The material of the side that `wi` is on, and its placement.
    #[inline]
    #[must_use]
    pub fn side(&self, placement: Placement, wi: Vec3) -> (MaterialId, Placement) {
        if placement.to_closure(wi).z >= 0.0 {
            (self.front, placement)
        } else {
            (self.back, placement.flipped())
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::material::assert_finds;
    use etendue_document::{Fault, Severity};

    #[test]
    fn materials_that_let_light_through_are_refused() {
        for nested in [
            r#"<bsdf type="dielectric"/>"#,
            r#"<bsdf type="mask"><bsdf type="diffuse"/></bsdf>"#,
            r#"<bsdf type="blendbsdf"><bsdf type="diffuse"/><bsdf type="thindielectric"/></bsdf>"#,
            r#"<bsdf type="normalmap"><rgb name="normalmap" value="0.5"/><bsdf type="null"/></bsdf>"#,
        ] {
            assert_finds(
                &format!(r#"<bsdf type="twosided">{nested}</bsdf>"#),
                Severity::Error,
                Fault::BadValue,
                "lets light through",
            );
        }
    }

    #[test]
    fn none_and_three_nested_materials_are_refused() {
        assert_finds(
            r#"<bsdf type="twosided"/>"#,
            Severity::Error,
            Fault::MissingParameter,
            "1 or 2 materials",
        );
        let nested = r#"<bsdf type="diffuse"/>"#.repeat(3);
        assert_finds(
            &format!(r#"<bsdf type="twosided">{nested}</bsdf>"#),
            Severity::Error,
            Fault::BadValue,
            "not 3",
        );
    }
}
