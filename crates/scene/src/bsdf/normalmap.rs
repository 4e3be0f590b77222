//! `normalmap`: a material on a surface whose normals come from an image.

use super::{Bsdf, Gather, Placement, WrapperMaterial};
use crate::builder::Builder;
use crate::ids::MaterialId;
use crate::manual::{Manual, ParameterManual, parameter};
use crate::models::bsdf_inputs::nested;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, one_way};
use crate::texture::ColorSource;
use etendue_document::{Fault, Parameters};
use etendue_math::Frame;
use etendue_spectrum::SpectrumUse;
use glam::Vec3;

/// What to do if the perturbed normal faces away from the viewer.
pub(crate) const FLIP_INVALID_NORMALS: ParameterManual = parameter(
    "flip_invalid_normals",
    "boolean",
    "true",
    "Whether a normal that faces away from the viewer is turned around, where the surface would \
     be black without.",
);
/// Whether the terminator is softened.
pub(crate) const USE_SHADOWING_FUNCTION: ParameterManual = parameter(
    "use_shadowing_function",
    "boolean",
    "true",
    "Whether light is faded out towards the horizon of the surface, as bumps would shadow it \
     (Estevez et al., *A Microfacet-Based Shadowing Function to Solve the Bump Terminator \
     Problem*, 2019).",
);

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Tilts the normals of a surface by a picture, whose colours (x + 1) / 2 hold the normal \
              in the shading frame: (0.5, 0.5, 1) changes nothing. Use a bitmap with `raw` set.",
    parameters: &[
        parameter("normalmap", "texture", "", "The picture of the normals."),
        parameter("(nested)", "bsdf", "", "The material."),
        FLIP_INVALID_NORMALS,
        USE_SHADOWING_FUNCTION,
    ],
    sample: r#"<bsdf type="normalmap">
    <rgb name="normalmap" value="0.5, 0.6, 0.9"/>
    <bsdf type="roughplastic"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        one_way(r#"<bsdf type="normalmap"><rgb name="normalmap" value="0.7, 0.4, 0.9"/><bsdf type="roughplastic"/></bsdf>"#),
        one_way(r#"<bsdf type="normalmap"><rgb name="normalmap" value="0.8, 0.4, 0.8"/><bsdf type="roughdielectric"><float name="alpha" value="0.4"/></bsdf></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="normalmap"><rgb name="normalmap" value="0.5, 0.5, 0.5"/><bsdf type="roughplastic"/></bsdf>"#,
        r#"<bsdf type="normalmap"><rgb name="normalmap" value="1, 0.5, 0.5"/><bsdf type="roughdielectric"/></bsdf>"#,
        r#"<bsdf type="normalmap"><rgb name="normalmap" value="1, 0, 0"/><bsdf type="twosided"><bsdf type="roughconductor"/></bsdf></bsdf>"#,
    ],
    batched: &[],
};

/// A material with a normal map.
#[derive(Clone, Copy, Debug)]
pub struct NormalMap {
    map: ColorSource,
    perturbation: Perturbation,
    pub(crate) nested: MaterialId,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<NormalMap> {
    let perturbation = Perturbation::read(parameters);
    let nested = nested(builder, parameters, 1..=1);
    let map = builder.optional_color(parameters, "normalmap", SpectrumUse::Unbounded);
    if map.is_none() && !parameters.has("normalmap") {
        let message = "`normalmap` needs a texture named `normalmap`";
        parameters.error(Fault::MissingParameter, "normalmap", message);
    }
    Some(NormalMap { map: map?, perturbation, nested: nested?[0] })
}

/// How bump and normal maps use the normal they found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Perturbation {
    facing: Facing,
    shadowing: Shadowing,
}

/// What to do with a normal that faces away from the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Facing {
    /// Its tangential part is reversed (Schüssler et al., *Microfacet-Based Normal Mapping for
    /// Robust Monte Carlo Path Tracing*, 2017).
    Flipped,
    /// It is kept.
    Kept,
}

/// How light behaves towards the horizon of the unperturbed surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shadowing {
    /// It fades out, as with microfacet shadowing.
    Smooth,
    /// It is cut off abruptly.
    None,
}

impl Perturbation {
    /// Reads the parameters that both kinds of map share.
    pub(crate) fn read(parameters: &Parameters<'_>) -> Self {
        let facing = match parameters.boolean("flip_invalid_normals", true) {
            true => Facing::Flipped,
            false => Facing::Kept,
        };
        let shadowing = match parameters.boolean("use_shadowing_function", true) {
            true => Shadowing::Smooth,
            false => Shadowing::None,
        };
        Self { facing, shadowing }
    }

    /// `placement` with its z axis turned to `normal`, which is in the placement's coordinates and
    /// need not be normalised. `wi` is in shading coordinates.
    pub(crate) fn place(&self, normal: Vec3, wi: Vec3, placement: Placement) -> Placement {
        let wi = placement.to_closure(wi);
        let away = wi.z * wi.dot(normal) <= 0.0;
        let normal = match self.facing {
            Facing::Flipped if away => Vec3::new(-normal.x, -normal.y, normal.z),
            _ => normal,
        };
        // A zero or invalid normal changes nothing.
        let normal = normal.try_normalize().unwrap_or(Vec3::Z);
        let turned = placement.turned(Frame::from_normal_and_tangent(normal, Vec3::X));
        match self.shadowing {
            Shadowing::Smooth => turned.shadowed(normal),
            Shadowing::None => turned,
        }
    }
}

impl WrapperMaterial for NormalMap {
    fn transmits(&self, nested: &dyn Fn(MaterialId) -> bool) -> bool {
        nested(self.nested)
    }

    /// Adds the nested closures in the tilted frame.
    fn gather<'a>(&self, gather: &Gather<'a, '_>, placement: Placement, bsdf: &mut Bsdf<'a>) {
        // The image holds data, not light. Its three channels are the coordinates.
        let color = self.map.eval(gather.textures, gather.surface);
        let normal = Vec3::from_array(color.rgb()) * 2.0 - Vec3::ONE;
        let placement = self.perturbation.place(normal, gather.surface.wi, placement);
        gather.add(self.nested, placement, bsdf);
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::Transport;
    use crate::testing::material::{TestMaterial, assert_finds, assert_same};
    use etendue_document::{Fault, Severity};
    use glam::Vec3;

    #[test]
    fn a_flat_map_changes_nothing() {
        for nested in [
            r#"<bsdf type="roughconductor"><float name="alpha_u" value="0.4"/><float name="alpha_v" value="0.1"/></bsdf>"#,
            r#"<bsdf type="roughdielectric"/>"#,
            r#"<bsdf type="mask"><bsdf type="diffuse"/></bsdf>"#,
        ] {
            let map = r#"<rgb name="normalmap" value="0.5, 0.5, 1"/>"#;
            assert_same(&format!(r#"<bsdf type="normalmap">{map}{nested}</bsdf>"#), nested);
        }
    }

    #[test]
    fn the_normal_is_that_of_the_map() {
        let material = TestMaterial::read(
            r#"<bsdf type="normalmap"><rgb name="normalmap" value="0.8, 0.5, 0.9"/><bsdf type="diffuse"/></bsdf>"#,
        );
        let normal = material.bsdf(Vec3::Z).normal();
        assert!((normal - Vec3::new(0.6, 0.0, 0.8)).length() < 1e-6);
    }

    #[test]
    fn normals_that_face_away_are_turned_only_if_asked_for() {
        let value = |flip: bool| {
            let xml = format!(
                r#"<bsdf type="normalmap"><rgb name="normalmap" value="1, 0.5, 0.6"/>
                   <boolean name="flip_invalid_normals" value="{flip}"/><bsdf type="diffuse"/></bsdf>"#
            );
            let wi = Vec3::new(-0.9, 0.0, 0.19_f32.sqrt());
            TestMaterial::read(&xml).bsdf(wi).eval_pdf(wi, wi, Transport::Radiance).0[0]
        };
        assert_eq!(value(false), 0.0);
        assert!(value(true) > 0.0);
    }

    #[test]
    fn without_a_map_or_a_material_it_is_refused() {
        assert_finds(
            r#"<bsdf type="normalmap"><bsdf type="diffuse"/></bsdf>"#,
            Severity::Error,
            Fault::MissingParameter,
            "normalmap",
        );
        assert_finds(
            r#"<bsdf type="normalmap"><rgb name="normalmap" value="0.5, 0.5, 1"/></bsdf>"#,
            Severity::Error,
            Fault::MissingParameter,
            "one material",
        );
    }
}
