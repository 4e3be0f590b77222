//! `bumpmap`: a material on a surface whose normals follow a height map.

use super::inputs::nested;
use super::normalmap::{FLIP_INVALID_NORMALS, Perturbation, USE_SHADOWING_FUNCTION};
use super::{Bsdf, Gather, Placement};
use crate::builder::Builder;
use crate::ids::{MaterialId, TextureId};
use crate::manual::{Manual, parameter};
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

/// A material with a height map.
#[derive(Clone, Copy, Debug)]
pub struct BumpMap {
    height: TextureId,
    scale: f32,
    perturbation: Perturbation,
    pub(super) nested: MaterialId,
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
    Some(BumpMap { height: height?, scale, perturbation, nested: nested?[0] })
}

impl BumpMap {
    /// Adds the nested closures in the tilted frame.
    pub fn gather<'a>(&self, gather: &Gather<'a, '_>, placement: Placement, bsdf: &mut Bsdf<'a>) {
        let normal = self.normal(gather, &placement);
        let placement = self.perturbation.place(normal, gather.surface.wi, placement);
        gather.materials.gather(self.nested, gather, placement, bsdf);
    }

    /// The normal of the raised surface, in the placement's frame, of any length.
    ///
    /// The tangents of p + h·n, without the small term of the derivative of n, as Blinn leaves it
    /// out; the base's tangents are first made perpendicular to the shading normal.
    fn normal(&self, gather: &Gather<'_, '_>, placement: &Placement) -> Vec3 {
        let surface = gather.surface;
        let gradient = gather.textures.gradient(self.height, surface) * self.scale;
        let base = placement.frame();
        let to_base = |v: Vec3| base.to_local(surface.to_local(v));
        let raised = |tangent: Vec3, slope: f32| to_base(tangent).with_z(slope);
        let normal = raised(surface.dp_du, gradient.x).cross(raised(surface.dp_dv, gradient.y));
        // The tangents may be left-handed: the normal stays on the side of the geometric one.
        if normal.dot(to_base(surface.normal)) < 0.0 { -normal } else { normal }
    }
}
