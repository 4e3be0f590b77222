//! `diffuse`: the ideal matt surface.

use super::inputs::reflectance;
use super::{BsdfSample, Closure, Lobe, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_sampling::warp::cosine_hemisphere;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The ideal matt surface (Lambert's): it looks equally bright from everywhere. \
              Black from behind; see `twosided`.",
    parameters: &[parameter(
        "reflectance",
        "spectrum or texture",
        "0.5",
        "The share of light that is scattered. `diffuse_reflectance` is taken too.",
    )],
    sample: r#"<bsdf type="diffuse">
    <rgb name="reflectance" value="0.2, 0.25, 0.7"/>
</bsdf>"#,
};

/// A Lambertian surface.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    reflectance: ColorSource,
}

impl Default for Diffuse {
    fn default() -> Self {
        Self { reflectance: ColorSource::Constant(Spectrum::splat(0.5)) }
    }
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Diffuse> {
    // The second name is that of the coated materials; scenes use it here as well.
    let name = match parameters.has("reflectance") || !parameters.has("diffuse_reflectance") {
        true => "reflectance",
        false => "diffuse_reflectance",
    };
    Some(Diffuse { reflectance: reflectance(builder, parameters, name, 0.5) })
}

impl Diffuse {
    /// Reads the textures at a hit.
    #[inline]
    #[must_use]
    pub fn resolve(&self, textures: Textures<'_>, surface: &SurfaceInteraction) -> DiffuseClosure {
        DiffuseClosure { reflectance: self.reflectance.eval(textures, surface) }
    }
}

/// A resolved Lambertian surface.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseClosure {
    reflectance: Spectrum,
}

impl Closure for DiffuseClosure {
    #[inline]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, _transport: Transport) -> (Spectrum, f32) {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let pdf = cosine_hemisphere::pdf(wo);
        (self.reflectance * pdf, pdf)
    }

    #[inline]
    fn sample(
        &self,
        wi: Vec3,
        _lobe: f32,
        direction: Vec2,
        _transport: Transport,
    ) -> Option<BsdfSample> {
        if wi.z <= 0.0 {
            return None;
        }
        let wo = cosine_hemisphere::sample(direction);
        let pdf = cosine_hemisphere::pdf(wo);
        let weight = self.reflectance;
        (pdf > 0.0).then_some(BsdfSample { wo, weight, pdf, eta: 1.0, lobe: Lobe::Diffuse })
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        if wi.z > 0.0 { self.reflectance } else { Spectrum::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::testing::{assert_finds, assert_same};
    use etendue_document::{Fault, Severity};

    #[test]
    fn the_name_of_the_coated_materials_is_taken_too() {
        assert_same(
            r#"<bsdf type="diffuse"><rgb name="diffuse_reflectance" value="0.1, 0.2, 0.3"/></bsdf>"#,
            r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.1, 0.2, 0.3"/></bsdf>"#,
        );
        assert_same(
            r#"<bsdf type="diffuse"><float name="reflectance" value="0.5"/></bsdf>"#,
            r#"<bsdf type="diffuse"/>"#,
        );
    }

    #[test]
    fn reflectances_out_of_range_are_found() {
        assert_finds(
            r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.5, 1.5, 0.5"/></bsdf>"#,
            Severity::Warning,
            Fault::BadValue,
            "above 1",
        );
        assert_finds(
            r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.5, -0.5, 0.5"/></bsdf>"#,
            Severity::Error,
            Fault::BadValue,
            "negative",
        );
    }
}
