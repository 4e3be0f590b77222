//! `roughplastic`: a rough clear coat over a matt base.

use super::coat::CoatTable;
use super::conductor::SPECULAR_REFLECTANCE;
use super::dielectric::EXT_IOR;
use super::inputs::{
    ColorShift, coated_base, distribution, reflectance, rough_relative_index, scalar_within,
    specular_probability,
};
use super::microfacet::Microfacets;
use super::plastic::{DIFFUSE_REFLECTANCE, INT_IOR, NONLINEAR};
use super::roughconductor::{ALPHA, DISTRIBUTION, SAMPLE_VISIBLE};
use super::{BsdfSample, Closure, Lobe, Transport, fresnel};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, ParameterManual};
use crate::texture::{ColorSource, ScalarSource, Textures};
use etendue_document::{Fault, Parameters};
use etendue_sampling::warp::cosine_hemisphere;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Plastic with a rough surface: a matt base under a clear coat of microfacets. Black \
              from behind; see `twosided`.",
    parameters: &[
        DIFFUSE_REFLECTANCE,
        SPECULAR_REFLECTANCE,
        INT_IOR,
        EXT_IOR,
        NONLINEAR,
        ParameterManual { kind: "float", ..ALPHA },
        DISTRIBUTION,
        SAMPLE_VISIBLE,
    ],
    sample: r#"<bsdf type="roughplastic">
    <string name="distribution" value="beckmann"/>
    <float name="int_ior" value="1.61"/>
    <rgb name="diffuse_reflectance" value="0, 0, 0"/>
</bsdf>"#,
};

/// A rough coat over a matt base.
#[derive(Clone, Debug)]
pub struct RoughPlastic {
    diffuse_reflectance: ColorSource,
    specular_reflectance: ColorSource,
    eta: f32,
    shift: ColorShift,
    microfacets: Microfacets,
    table: Box<CoatTable>,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<RoughPlastic> {
    let eta = rough_relative_index(builder, parameters, "polypropylene");
    let (distribution, sampling) = distribution(parameters);
    let alpha = constant_alpha(builder, parameters);
    let diffuse_reflectance = reflectance(builder, parameters, "diffuse_reflectance", 0.5);
    let specular_reflectance = reflectance(builder, parameters, "specular_reflectance", 1.0);
    let shift = ColorShift::read(parameters);
    let eta = eta?;
    Some(RoughPlastic {
        diffuse_reflectance,
        specular_reflectance,
        eta,
        shift,
        microfacets: Microfacets::new(distribution, sampling, Vec2::splat(alpha)),
        table: Box::new(CoatTable::new(distribution, alpha, eta)),
    })
}

/// The table of the coat is for one roughness: of a texture the mean is taken, with a warning.
fn constant_alpha(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> f32 {
    match scalar_within(builder, parameters, "alpha", 0.1, 0.0..=1e4) {
        ScalarSource::Constant(alpha) => alpha,
        source @ ScalarSource::Texture(_) => {
            let message = "`alpha` cannot vary over this material: the texture's mean is taken";
            parameters.warning(Fault::Approximation, "alpha", message);
            source.mean(Textures(&builder.textures))
        }
    }
}

impl RoughPlastic {
    /// Reads the textures at a hit.
    #[inline]
    #[must_use]
    pub fn resolve(
        &self,
        textures: Textures<'_>,
        surface: &SurfaceInteraction,
    ) -> RoughPlasticClosure<'_> {
        let reflectance = self.diffuse_reflectance.eval(textures, surface);
        let base = coated_base(reflectance, self.table.thrown_back, self.shift);
        RoughPlasticClosure {
            base: base / (self.eta * self.eta),
            reflectance,
            specular: self.specular_reflectance.eval(textures, surface),
            microfacets: self.microfacets,
            eta: self.eta,
            table: &self.table,
        }
    }
}

/// A resolved rough coat over a matt base.
#[derive(Clone, Copy, Debug)]
pub struct RoughPlasticClosure<'a> {
    /// The base's reflectance with the light thrown back, over the squared index.
    base: Spectrum,
    /// The base's reflectance alone, which weighs the choice of lobes.
    reflectance: Spectrum,
    specular: Spectrum,
    microfacets: Microfacets,
    eta: f32,
    table: &'a CoatTable,
}

impl Closure for RoughPlasticClosure<'_> {
    #[inline]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, _transport: Transport) -> (Spectrum, f32) {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let entering = self.table.entering(wi.z);
        let probability = specular_probability(self.specular, self.reflectance, 1.0 - entering);
        let m = (wi + wo).normalize_or_zero();
        let reflection = self.microfacets.reflection(wi, wo, m);
        let reflected = fresnel::dielectric(wi.dot(m), self.eta).reflectance;
        let cosine = cosine_hemisphere::pdf(wo);
        let value = self.specular * (reflected * reflection.value)
            + self.base * (cosine * entering * self.table.entering(wo.z));
        (value, probability * reflection.pdf + (1.0 - probability) * cosine)
    }

    #[inline]
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        if wi.z <= 0.0 {
            return None;
        }
        let reflected = 1.0 - self.table.entering(wi.z);
        let probability = specular_probability(self.specular, self.reflectance, reflected);
        let wo = if lobe < probability {
            let m = self.microfacets.sample(wi, direction);
            fresnel::reflect(wi, m)
        } else {
            cosine_hemisphere::sample(direction)
        };
        let (value, pdf) = self.eval_pdf(wi, wo, transport);
        let sample = || BsdfSample { wo, weight: value / pdf, pdf, eta: 1.0, lobe: Lobe::Smooth };
        (pdf > 0.0).then(sample)
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        if wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let entering = self.table.entering(wi.z);
        // As much leaves the coat as is not thrown back, over the squared index seen from outside.
        let leaving = (1.0 - self.table.thrown_back) * self.eta * self.eta;
        self.specular * (1.0 - entering) + self.base * (entering * leaving)
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::testing::{TestMaterial, assert_finds};
    use crate::texture::Texture;
    use etendue_document::{Fault, Severity};
    use glam::Vec3;

    #[test]
    fn a_texture_of_the_roughness_is_averaged_aloud() {
        assert_finds(
            r#"<bsdf type="roughplastic"><texture name="alpha" type="checkerboard"/></bsdf>"#,
            Severity::Warning,
            Fault::Approximation,
            "mean",
        );
    }

    #[test]
    fn textures_are_read_at_the_hit() {
        let mut material = TestMaterial::read(
            r#"<bsdf type="roughplastic"><texture name="diffuse_reflectance" type="checkerboard"/></bsdf>"#,
        );
        let bright = material.bsdf(Vec3::Z).albedo(Vec3::Z);
        material.textures = vec![Texture::Constant(etendue_spectrum::Spectrum::ZERO)];
        let black = material.bsdf(Vec3::Z).albedo(Vec3::Z);
        // Without its base the coat alone reflects some 4 %.
        assert!(black[0] > 0.03 && black[0] < 0.05 && bright[0] > 0.2, "{black:?} {bright:?}");
    }
}
