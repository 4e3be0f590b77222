//! `bumpmap`: a material on a surface whose normals are perturbed by a height map.

use super::normalmap::{FLIP_INVALID_NORMALS, Perturbation, USE_SHADOWING_FUNCTION};
use super::{Bsdf, Gather, Placement, WrapperMaterial};
use crate::builder::Builder;
use crate::ids::{MaterialId, TextureId};
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::nested;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, one_way};
use crate::texture::Texture;
use etendue_document::{Fault, Parameters};
use glam::Vec3;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Tilts the normals of a surface as if it were raised by a height map, which adds detail \
              without geometry (Blinn, *Simulation of Wrinkled Surfaces*, 1978). Use a bitmap with \
              `raw` set.",
    parameters: &[
        parameter("(nested)", "texture", "", "The height, in scene units; any name will do."),
        parameter("(nested)", "bsdf", "", "The material."),
        parameter("scale", "float", "1", "A factor on the height."),
        FLIP_INVALID_NORMALS,
        USE_SHADOWING_FUNCTION,
    ],
    sample: r#"<bsdf type="bumpmap">
    <texture name="height" type="checkerboard"/>
    <float name="scale" value="0.1"/>
    <bsdf type="roughplastic"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        one_way(r#"<bsdf type="bumpmap"><texture type="checkerboard"/><bsdf type="diffuse"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="bumpmap"><float name="scale" value="1e30"/><texture type="checkerboard"/><bsdf type="roughdielectric"/></bsdf>"#,
    ],
    batched: &[],
};

/// A material with a height map.
#[derive(Clone, Copy, Debug)]
pub struct BumpMap {
    height: TextureId,
    scale: f32,
    perturbation: Perturbation,
    pub(crate) nested: MaterialId,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<BumpMap> {
    let scale = parameters.float_in("scale", 1.0, -1e30..=1e30) as f32;
    let perturbation = Perturbation::read(parameters);
    let nested = nested(builder, parameters, 1..=1);
    let height = parameters.required_child(etendue_document::Class::Texture);
    let height = builder.texture(height?.node);
    if parameters.unnamed_child(etendue_document::Class::Texture).is_some() {
        let message = "`bumpmap` takes one texture, the height";
        parameters.diagnostics().error(Fault::BadValue, parameters.span(), message);
    }
    if let Some(Texture::MeshAttribute(_)) = height.map(|id| &builder.textures[id.index()]) {
        let message = "attributes of meshes have no slope here: this `bumpmap` changes nothing";
        parameters.diagnostics().warning(Fault::Unsupported, parameters.span(), message);
    }
    Some(BumpMap { height: height?, scale, perturbation, nested: nested?[0] })
}

impl WrapperMaterial for BumpMap {
    fn transmits(&self, nested: &dyn Fn(MaterialId) -> bool) -> bool {
        nested(self.nested)
    }

    /// Adds the nested closures in the tilted frame.
    fn gather<'a>(&self, gather: &Gather<'a, '_>, placement: Placement, bsdf: &mut Bsdf<'a>) {
        let normal = self.normal(gather, &placement);
        let placement = self.perturbation.place(normal, gather.surface.wi, placement);
        gather.add(self.nested, placement, bsdf);
    }
}

impl BumpMap {
    /// The normal of the displaced surface, in the placement's frame, not normalised.
    ///
    /// It follows from the tangents of p + h·n. Like Blinn's, they omit the small term with the
    /// derivative of n. The base tangents are first made perpendicular to the shading normal.
    fn normal(&self, gather: &Gather<'_, '_>, placement: &Placement) -> Vec3 {
        let surface = gather.surface;
        let gradient = gather.textures.gradient(self.height, surface) * self.scale;
        let base = placement.frame();
        let to_base = |v: Vec3| base.to_local(surface.to_local(v));
        let raised = |tangent: Vec3, slope: f32| to_base(tangent).with_z(slope);
        let normal = raised(surface.dp_du, gradient.x).cross(raised(surface.dp_dv, gradient.y));
        // The tangents may be left-handed. Keep the normal on the side of the geometric one.
        if normal.dot(to_base(surface.normal)) < 0.0 { -normal } else { normal }
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::Transport;
    use crate::testing::material::{TestMaterial, assert_finds, assert_same, surface};
    use crate::texture::Texture;
    use crate::texture::bitmap::{BitmapOptions, BitmapTexture};
    use etendue_document::{Fault, Severity};
    use etendue_image::{Bitmap, Samples};
    use glam::Vec3;

    /// A height map whose gradient at the test surface's uv is (−0.12, 0.46).
    fn height() -> Texture {
        let rows = [
            [1.0, 3.0, 2.0, 5.0],
            [4.0, 2.0, 6.0, 1.0],
            [3.0, 9.0, 2.0, 4.0],
            [5.0, 1.0, 7.0, 3.0],
        ];
        let samples = rows.iter().flatten().map(|height: &f32| 0.025 * height).collect();
        let bitmap = Bitmap {
            width: 4,
            height: 4,
            channels: 1,
            samples: Samples::F32(samples),
            ..Bitmap::default()
        };
        let options = BitmapOptions { raw: true, ..BitmapOptions::default() };
        Texture::Bitmap(BitmapTexture::new(bitmap, &options).expect("a picture with texels"))
    }

    #[test]
    fn tilted_normals_give_the_values_of_mitsuba() {
        let scale = |scale: f32| format!(r#"<float name="scale" value="{scale}"/>"#);
        let sharp = r#"<boolean name="use_shadowing_function" value="false"/>"#;
        let steep = [Vec3::new(0.2, 0.1, 0.9), Vec3::new(-0.8, 0.2, 0.1)].map(Vec3::normalize);
        // Settings, tangents, incident direction, value, density.
        let table = [
            (scale(1.0), [Vec3::X, Vec3::Y], steep[0], 0.053_684_5, 0.054_478_44),
            (scale(1.0), [Vec3::X, Vec3::Y], steep[1], 0.266_82, 0.270_765_96),
            (
                scale(0.5),
                [Vec3::new(2.0, 0.3, 0.4), Vec3::new(-0.2, 1.5, -0.1)],
                steep[0],
                0.138_212,
                0.138_432_8,
            ),
            (
                scale(2.0) + sharp,
                [Vec3::new(1.0, 0.2, 0.0), Vec3::new(0.3, -1.0, 0.0)],
                steep[1],
                0.279_85,
                0.279_850_16,
            ),
        ];
        let wo = Vec3::new(-0.3, 0.5, 0.4).normalize();
        for (settings, [dp_du, dp_dv], wi, value, pdf) in table {
            let mut material = TestMaterial::read(&format!(
                r#"<bsdf type="bumpmap"><texture type="checkerboard"/>{settings}
                   <bsdf type="diffuse"><float name="reflectance" value="1"/></bsdf></bsdf>"#
            ));
            material.textures = vec![height()];
            let surface = crate::SurfaceInteraction { dp_du, dp_dv, ..surface(wi) };
            let actual = material.bsdf_at(&surface).eval_pdf(wi, wo, Transport::Radiance);
            assert!((actual.0[0] - value).abs() < 2e-6, "{settings}: {actual:?} {value}");
            assert!((actual.1 - pdf).abs() < 2e-6, "{settings}: {actual:?} {pdf}");
        }
    }

    #[test]
    fn an_even_height_changes_nothing() {
        let nested = r#"<bsdf type="roughconductor"><float name="alpha_u" value="0.4"/><float name="alpha_v" value="0.1"/></bsdf>"#;
        let map = r#"<texture name="any" type="checkerboard"/>"#;
        assert_same(&format!(r#"<bsdf type="bumpmap">{map}{nested}</bsdf>"#), nested);
    }

    #[test]
    fn it_takes_one_texture_and_one_material() {
        assert_finds(
            r#"<bsdf type="bumpmap"><bsdf type="diffuse"/></bsdf>"#,
            Severity::Error,
            Fault::MissingParameter,
            "texture",
        );
        let map = r#"<texture type="checkerboard"/>"#;
        assert_finds(
            &format!(r#"<bsdf type="bumpmap">{map}</bsdf>"#),
            Severity::Error,
            Fault::MissingParameter,
            "one material",
        );
        assert_finds(
            &format!(r#"<bsdf type="bumpmap">{map}{map}<bsdf type="diffuse"/></bsdf>"#),
            Severity::Error,
            Fault::BadValue,
            "one texture",
        );
    }
}
