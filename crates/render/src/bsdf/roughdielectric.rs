//! `roughdielectric`: frosted glass, made of microfacets.

use super::conductor::SPECULAR_REFLECTANCE;
use super::dielectric::{EXT_IOR, INT_IOR, SPECULAR_TRANSMITTANCE, radiance_scale};
use super::inputs::{Roughness, reflectance, rough_relative_index};
use super::microfacet::{Microfacets, NormalSampling};
use super::roughconductor::{ALPHA, ALPHA_U, ALPHA_V, DISTRIBUTION, SAMPLE_VISIBLE};
use super::{BsdfSample, Closure, Lobe, Transport, fresnel};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::Manual;
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A rough interface between two clear substances, such as frosted glass (Walter et al., \
              *Microfacet Models for Refraction through Rough Surfaces*, 2007). The normal points \
              outside.",
    parameters: &[
        INT_IOR,
        EXT_IOR,
        SPECULAR_REFLECTANCE,
        SPECULAR_TRANSMITTANCE,
        ALPHA,
        ALPHA_U,
        ALPHA_V,
        DISTRIBUTION,
        SAMPLE_VISIBLE,
    ],
    sample: r#"<bsdf type="roughdielectric">
    <string name="distribution" value="ggx"/>
    <float name="alpha" value="0.2"/>
    <string name="int_ior" value="bk7"/>
</bsdf>"#,
};

/// A rough dielectric interface.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric {
    eta: f32,
    specular_reflectance: ColorSource,
    specular_transmittance: ColorSource,
    roughness: Roughness,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<RoughDielectric> {
    let eta = rough_relative_index(builder, parameters, "bk7");
    let specular_reflectance = reflectance(builder, parameters, "specular_reflectance", 1.0);
    let specular_transmittance = reflectance(builder, parameters, "specular_transmittance", 1.0);
    let roughness = Roughness::read(builder, parameters);
    Some(RoughDielectric { eta: eta?, specular_reflectance, specular_transmittance, roughness })
}

impl RoughDielectric {
    /// Reads the textures at a hit.
    #[inline]
    #[must_use]
    pub fn resolve(
        &self,
        textures: Textures<'_>,
        surface: &SurfaceInteraction,
    ) -> RoughDielectricClosure {
        RoughDielectricClosure {
            reflectance: self.specular_reflectance.eval(textures, surface),
            transmittance: self.specular_transmittance.eval(textures, surface),
            eta: self.eta,
            microfacets: self.roughness.resolve(textures, surface),
        }
    }
}

/// A resolved rough dielectric interface.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectricClosure {
    reflectance: Spectrum,
    transmittance: Spectrum,
    eta: f32,
    microfacets: Microfacets,
}

/// The interface as seen from the side of `wi`, which is above.
struct Facing<'a> {
    closure: &'a RoughDielectricClosure,
    wi: Vec3,
    /// The index below over the index above.
    eta: f32,
    /// The distribution that normals are sampled from.
    sampled: Microfacets,
}

impl RoughDielectricClosure {
    /// Turns what comes from below upside down. The distribution of normals is symmetric, so the
    /// whole vectors can be negated. The factor is −1 then: it takes directions there and back.
    #[inline]
    fn facing(&self, wi: Vec3) -> Option<(Facing<'_>, f32)> {
        if wi.z == 0.0 {
            return None;
        }
        let (side, eta) = if wi.z > 0.0 { (1.0, self.eta) } else { (-1.0, 1.0 / self.eta) };
        let wi = wi * side;
        let sampled = match self.microfacets.sampling() {
            NormalSampling::Visible => self.microfacets,
            // Walter et al., section 5.3: a wider distribution keeps the weights down.
            NormalSampling::All => self.microfacets.scaled(1.2 - 0.2 * wi.z.sqrt()),
        };
        Some((Facing { closure: self, wi, eta, sampled }, side))
    }
}

impl Facing<'_> {
    /// The normal of the microfacets that take the light to `wo`, above the surface; `None` where
    /// there is none, or where it cannot be seen from both.
    #[inline]
    fn normal(&self, wo: Vec3) -> Option<Vec3> {
        let relative = if wo.z > 0.0 { 1.0 } else { self.eta };
        let m = (self.wi + wo * relative).normalize_or_zero();
        let m = if m.z < 0.0 { -m } else { m };
        (self.wi.dot(m) > 0.0 && wo.dot(m) * wo.z > 0.0).then_some(m)
    }

    #[inline]
    fn eval_pdf_at(&self, wo: Vec3, m: Vec3, transport: Transport) -> (Spectrum, f32) {
        let reflected = fresnel::dielectric(self.wi.dot(m), self.eta).reflectance;
        let (tint, share, (value, pdf)) = if wo.z > 0.0 {
            (self.closure.reflectance, reflected, self.reflection(wo, m))
        } else {
            let tint = self.closure.transmittance * radiance_scale(1.0 / self.eta, transport);
            (tint, 1.0 - reflected, self.transmission(wo, m))
        };
        // The Jacobians overflow along grazing microfacets, and straight on where the indices are
        // nearly equal.
        if !(value.is_finite() && pdf.is_finite()) {
            return (Spectrum::ZERO, 0.0);
        }
        (tint * (share * value), share * pdf)
    }

    #[inline]
    fn reflection(&self, wo: Vec3, m: Vec3) -> (f32, f32) {
        let reflection = self.closure.microfacets.reflection(self.wi, wo, m);
        let pdf = match self.sampled.sampling() {
            NormalSampling::Visible => reflection.pdf,
            NormalSampling::All => 0.25 * self.sampled.pdf(self.wi, m) / self.wi.dot(m),
        };
        (reflection.value, pdf)
    }

    /// Walter et al., equation 21 without Fresnel's term, and the density after equation 17.
    #[inline]
    fn transmission(&self, wo: Vec3, m: Vec3) -> (f32, f32) {
        let microfacets = &self.closure.microfacets;
        let (cos_i, cos_o) = (self.wi.dot(m), wo.dot(m).abs());
        let root = cos_i - self.eta * cos_o;
        let jacobian = self.eta * self.eta * cos_o / (root * root);
        let masking = microfacets.masking_over_cosine(self.wi)
            * (microfacets.masking_over_cosine(wo) * -wo.z);
        let value = microfacets.density(m) * masking * cos_i * jacobian;
        (value, self.sampled.pdf(self.wi, m) * jacobian)
    }
}

impl Closure for RoughDielectricClosure {
    #[inline]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32) {
        let nothing = (Spectrum::ZERO, 0.0);
        let Some((facing, side)) = self.facing(wi) else { return nothing };
        let wo = wo * side;
        facing.normal(wo).map_or(nothing, |m| facing.eval_pdf_at(wo, m, transport))
    }

    #[inline]
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let (facing, side) = self.facing(wi)?;
        let m = facing.sampled.sample(facing.wi, direction);
        let cosine = facing.wi.dot(m);
        if cosine <= 0.0 {
            return None;
        }
        let interface = fresnel::dielectric(cosine, facing.eta);
        let (wo, eta) = if lobe < interface.reflectance {
            (fresnel::reflect(facing.wi, m), 1.0)
        } else {
            (fresnel::refract(facing.wi, m, &interface), facing.eta)
        };
        // Light that would need a second microfacet is lost.
        let reflected = lobe < interface.reflectance;
        if wo.z == 0.0 || (wo.z > 0.0) != reflected {
            return None;
        }
        let (value, pdf) = facing.eval_pdf_at(wo, m, transport);
        let sample =
            || BsdfSample { wo: wo * side, weight: value / pdf, pdf, eta, lobe: Lobe::Smooth };
        (pdf > 0.0).then(sample)
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        let reflected = fresnel::dielectric(wi.z, self.eta).reflectance;
        self.reflectance * reflected + self.transmittance * (1.0 - reflected)
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::Transport;
    use crate::bsdf::testing::{TestMaterial, assert_finds};
    use etendue_document::{Fault, Severity};
    use etendue_testkit::TestRng;

    #[test]
    fn equal_indices_are_no_interface() {
        assert_finds(
            r#"<bsdf type="roughdielectric"><string name="int_ior" value="air"/></bsdf>"#,
            Severity::Error,
            Fault::BadValue,
            "must differ",
        );
    }

    #[test]
    fn transmitted_radiance_is_importance_over_the_squared_index() {
        let glass = TestMaterial::read(
            r#"<bsdf type="roughdielectric"><float name="alpha" value="0.5"/>
               <float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>"#,
        );
        let mut random = TestRng::new(8);
        let mut transmitted = 0;
        for _ in 0..1000 {
            let (wi, wo) = (random.unit_vector(), random.unit_vector());
            let bsdf = glass.bsdf(wi);
            let value = |transport| bsdf.eval_pdf(wi, wo, transport).0[0];
            let (radiance, importance) = (value(Transport::Radiance), value(Transport::Importance));
            let scale = match (wi.z > 0.0, wo.z > 0.0) {
                (true, false) => 1.0 / 2.25,
                (false, true) => 2.25,
                _ => 1.0,
            };
            transmitted += usize::from(scale != 1.0 && importance > 0.0);
            assert!((radiance - scale * importance).abs() <= 1e-5 * radiance);
        }
        assert!(transmitted > 50);
    }
}
