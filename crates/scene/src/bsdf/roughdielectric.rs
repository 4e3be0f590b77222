//! `roughdielectric`: frosted glass with microfacets.

use super::conductor::SPECULAR_REFLECTANCE;
use super::dielectric::{EXT_IOR, INT_IOR, SPECULAR_TRANSMITTANCE, radiance_scale};
use super::roughconductor::{ALPHA, ALPHA_U, ALPHA_V, DISTRIBUTION, SAMPLE_VISIBLE};
use super::{ClosureMaterial, LaneMaterial, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{HitClosure, LaneClosure, SampleLanes, columns};
use crate::manual::Manual;
use crate::models::bsdf_inputs::{Roughness, reflectance, rough_relative_index};
use crate::models::fresnel;
use crate::models::microfacet::{Distribution, Microfacets, NormalSampling};
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, plain};
use crate::texture::{ColorSource, Textures};
use etendue_document::Parameters;
use etendue_math::lanes::{Mask as _, Real, Vector2, Vector3};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::Vec3;

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

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="roughdielectric"><float name="alpha" value="0.1"/></bsdf>"#),
        plain(r#"<bsdf type="roughdielectric"><float name="alpha_u" value="0.5"/><float name="alpha_v" value="0.2"/><rgb name="specular_reflectance" value="0.9, 0.5, 0.7"/></bsdf>"#),
        plain(r#"<bsdf type="roughdielectric"><string name="distribution" value="ggx"/><float name="alpha" value="0.5"/></bsdf>"#),
        plain(r#"<bsdf type="roughdielectric"><string name="distribution" value="ggx"/><float name="alpha" value="0.3"/><float name="int_ior" value="1"/><float name="ext_ior" value="1.7"/></bsdf>"#),
        plain(r#"<bsdf type="roughdielectric"><float name="alpha" value="0.4"/><boolean name="sample_visible" value="false"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="roughdielectric"><float name="alpha" value="0"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><float name="alpha" value="0.001"/><string name="distribution" value="ggx"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><float name="alpha" value="0.5"/><float name="int_ior" value="1.000001"/><float name="ext_ior" value="1"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><float name="alpha" value="0.001"/><float name="int_ior" value="1.0001"/><float name="ext_ior" value="1"/><string name="distribution" value="ggx"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><float name="alpha" value="3"/><float name="int_ior" value="1000"/><boolean name="sample_visible" value="false"/></bsdf>"#,
    ],
    batched: &[
        r#"<bsdf type="roughdielectric"><string name="distribution" value="beckmann"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><string name="distribution" value="beckmann"/><float name="alpha" value="0"/><string name="ext_ior" value="diamond"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><string name="distribution" value="beckmann"/><float name="alpha" value="0.6"/><float name="int_ior" value="1.000001"/><float name="ext_ior" value="1"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><string name="distribution" value="beckmann"/><float name="alpha_u" value="0.3"/><texture name="alpha_v" type="checkerboard"/><texture name="specular_reflectance" type="checkerboard"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><string name="distribution" value="ggx"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><string name="distribution" value="ggx"/><float name="alpha" value="0"/><string name="ext_ior" value="diamond"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><string name="distribution" value="ggx"/><float name="alpha" value="0.6"/><float name="int_ior" value="1.000001"/><float name="ext_ior" value="1"/></bsdf>"#,
        r#"<bsdf type="roughdielectric"><string name="distribution" value="ggx"/><float name="alpha_u" value="0.3"/><texture name="alpha_v" type="checkerboard"/><texture name="specular_reflectance" type="checkerboard"/></bsdf>"#,
    ],
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

impl ClosureMaterial for RoughDielectric {
    type Closure<'a> = RoughDielectricClosure;

    fn transmits(&self) -> bool {
        true
    }

    #[inline]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> RoughDielectricClosure {
        RoughDielectricClosure {
            reflectance: self.specular_reflectance.eval(textures, surface).into(),
            transmittance: self.specular_transmittance.eval(textures, surface).into(),
            eta: self.eta,
            microfacets: self.roughness.resolve(textures, surface),
        }
    }
}

impl LaneMaterial for RoughDielectric {
    type Variant = Distribution;
    type Blank = RoughDielectricClosure;

    fn variant(&self) -> Option<Distribution> {
        self.roughness.visible_distribution()
    }

    #[inline(always)]
    fn blank(distribution: Distribution) -> Self::Blank {
        let [reflectance, transmittance] = Default::default();
        let microfacets = Microfacets::visible(distribution);
        RoughDielectricClosure { reflectance, transmittance, eta: 1.0, microfacets }
    }

    fn is_uniform(&self) -> bool {
        self.specular_reflectance.is_constant()
            && self.specular_transmittance.is_constant()
            && self.roughness.is_uniform()
    }
}

/// A resolved rough dielectric interface.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectricClosure<R = f32> {
    reflectance: SpectrumLanes<R>,
    transmittance: SpectrumLanes<R>,
    eta: R,
    microfacets: Microfacets<R>,
}

columns!(RoughDielectricClosure { reflectance, transmittance, eta, microfacets });

/// The interface seen from the side of `wi`, which is above it.
struct Facing<'a, R> {
    closure: &'a RoughDielectricClosure<R>,
    wi: Vector3<R>,
    /// The index below over the index above.
    eta: R,
    /// The distribution that normals are sampled from.
    sampled: Microfacets<R>,
    /// −1 if everything is flipped, else 1.
    side: R,
}

/// A value without its colour, and a density.
struct Share<R> {
    value: R,
    pdf: R,
}

impl<R: Real> Share<R> {
    #[inline(always)]
    fn nothing(like: R) -> Self {
        Self { value: like.zero(), pdf: like.zero() }
    }
}

impl<R: Real> RoughDielectricClosure<R> {
    /// Flips directions so that `wi` is above. The distribution of normals is symmetric, so whole
    /// vectors can be negated.
    #[inline(always)]
    fn facing(&self, wi: Vector3<R>) -> Facing<'_, R> {
        let is_front = wi.z.above(0.0);
        let one = wi.z.like(1.0);
        let side = R::select(is_front, one, -one);
        let wi = wi * side;
        let eta = R::select(is_front, self.eta, self.eta.reciprocal());
        let sampled = match self.microfacets.sampling() {
            NormalSampling::Visible => self.microfacets,
            // Walter et al., section 5.3: a wider distribution bounds the weights.
            NormalSampling::All => self.microfacets.scaled(-wi.z.sqrt() * 0.2 + 1.2),
        };
        Facing { closure: self, wi, eta, sampled, side }
    }
}

impl<R: Real> Facing<'_, R> {
    /// The normal of the microfacets that scatter light to `wo`, above the surface, and whether it
    /// exists and is visible from both directions.
    #[inline(always)]
    fn normal(&self, wo: Vector3<R>) -> (Vector3<R>, R::Mask) {
        let relative = R::select(wo.z.above(0.0), self.eta.like(1.0), self.eta);
        let m = (self.wi + wo * relative).normalize_or_zero();
        let m = Vector3::select(m.z.below(0.0), -m, m);
        (m, self.wi.dot(m).above(0.0) & (wo.dot(m) * wo.z).above(0.0))
    }

    #[inline(always)]
    fn eval_pdf_at(
        &self,
        wo: Vector3<R>,
        m: Vector3<R>,
        transport: Transport,
    ) -> (SpectrumLanes<R>, R) {
        let reflected = fresnel::dielectric(self.wi.dot(m), self.eta).reflectance;
        let reflects = wo.z.above(0.0);
        let [mut reflection, mut transmission] = [(), ()].map(|()| Share::nothing(reflected));
        if reflects.any() {
            reflection = self.reflection(wo, m);
        }
        if !reflects.all() {
            transmission = self.transmission(wo, m);
        }
        let share = R::select(reflects, reflected, -reflected + 1.0);
        let value = R::select(reflects, reflection.value, transmission.value);
        let pdf = R::select(reflects, reflection.pdf, transmission.pdf);
        // The Jacobians overflow at grazing microfacets, and straight ahead if the indices are
        // nearly equal.
        let exists = value.is_finite() & pdf.is_finite();
        let value = R::select(exists, share * value, share.zero());
        let scale = radiance_scale(self.eta.reciprocal(), transport);
        let (mirror, through) = (self.closure.reflectance, self.closure.transmittance * scale);
        let tint = SpectrumLanes::select(reflects, mirror, through);
        (tint * value, R::select(exists, share * pdf, share.zero()))
    }

    #[inline(always)]
    fn reflection(&self, wo: Vector3<R>, m: Vector3<R>) -> Share<R> {
        let reflection = self.closure.microfacets.reflection(self.wi, wo, m);
        let pdf = match self.sampled.sampling() {
            NormalSampling::Visible => reflection.pdf,
            NormalSampling::All => self.sampled.pdf(self.wi, m) * 0.25 / self.wi.dot(m),
        };
        Share { value: reflection.value, pdf }
    }

    /// Walter et al., equation 21 without Fresnel's term, and the density after equation 17.
    #[inline(always)]
    fn transmission(&self, wo: Vector3<R>, m: Vector3<R>) -> Share<R> {
        let microfacets = &self.closure.microfacets;
        let (cos_i, cos_o) = (self.wi.dot(m), wo.dot(m).abs());
        let root = cos_i - self.eta * cos_o;
        let jacobian = self.eta * self.eta * cos_o / (root * root);
        let masking = microfacets.masking_over_cosine(self.wi)
            * (microfacets.masking_over_cosine(wo) * -wo.z);
        let value = microfacets.density(m) * masking * cos_i * jacobian;
        Share { value, pdf: self.sampled.pdf(self.wi, m) * jacobian }
    }
}

impl<R: Real> LaneClosure<R> for RoughDielectricClosure<R> {
    #[inline(always)]
    fn eval_pdf_lanes(
        &self,
        wi: Vector3<R>,
        wo: Vector3<R>,
        transport: Transport,
    ) -> (SpectrumLanes<R>, R) {
        let facing = self.facing(wi);
        let wo = wo * facing.side;
        let (m, exists) = facing.normal(wo);
        let nothing = (SpectrumLanes::grey(wi.z.zero()), wi.z.zero());
        if !exists.any() {
            return nothing;
        }
        let (value, pdf) = facing.eval_pdf_at(wo, m, transport);
        (SpectrumLanes::select(exists, value, nothing.0), R::select(exists, pdf, nothing.1))
    }

    #[inline(always)]
    fn sample_lanes(
        &self,
        wi: Vector3<R>,
        lobe: R,
        direction: Vector2<R>,
        transport: Transport,
    ) -> SampleLanes<R> {
        let facing = self.facing(wi);
        let m = facing.sampled.sample(facing.wi, direction);
        let cosine = facing.wi.dot(m);
        let interface = fresnel::dielectric(cosine, facing.eta);
        let reflects = lobe.lt(interface.reflectance);
        let reflected = fresnel::reflect_lanes(facing.wi, m);
        let refracted = fresnel::refract_lanes(facing.wi, m, &interface);
        let wo = Vector3::select(reflects, reflected, refracted);
        // Light that would need a second microfacet is lost.
        let stays = reflects & wo.z.above(0.0) | !reflects & wo.z.below(0.0);
        let exists = facing.wi.z.above(0.0) & cosine.above(0.0) & stays;
        if !exists.any() {
            return SampleLanes::none(wi);
        }
        let (value, pdf) = facing.eval_pdf_at(wo, m, transport);
        SampleLanes {
            wo: wo * facing.side,
            weight: value * pdf.reciprocal(),
            pdf,
            eta: R::select(reflects, pdf.like(1.0), facing.eta),
            exists: exists & pdf.above(0.0),
            ..SampleLanes::smooth(wi)
        }
    }
}

impl HitClosure for RoughDielectricClosure {
    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        let reflected = fresnel::dielectric(wi.z, self.eta).reflectance;
        (self.reflectance * reflected + self.transmittance * (1.0 - reflected)).into()
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::Transport;
    use crate::testing::material::{TestMaterial, assert_finds};
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
