//! `principledthin`: Disney's material for thin sheets: leaves, paper, curtains.

use super::{BsdfSample, Closure, ClosureMaterial, Lobe, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::{limited, scalar_within};
use crate::models::disney::{
    ANISOTROPIC, BASE_COLOR, Base, BaseParameters, FLATNESS, ROUGHNESS, SHEEN, SHEEN_TINT,
    SPEC_TINT, normal_reflectance, sampling_rate, schlick,
};
use crate::models::fresnel;
use crate::models::microfacet::Microfacets;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, one_way, plain};
use crate::texture::{ScalarSource, Textures};
use etendue_document::Parameters;
use etendue_sampling::warp::cosine_hemisphere;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A thin sheet, the same from both sides, which light passes without being bent: \
              leaves, paper, curtains (Burley, *Extending the Disney BRDF to a BSDF*, 2015).",
    parameters: &[
        BASE_COLOR,
        ROUGHNESS,
        ANISOTROPIC,
        parameter(
            "spec_trans",
            "float or texture",
            "0",
            "From diffuse (0) to specular (1): a clear or frosted foil.",
        ),
        parameter(
            "eta",
            "float or texture",
            "1.5",
            "The index of refraction over that of what is around.",
        ),
        SPEC_TINT,
        SHEEN,
        SHEEN_TINT,
        FLATNESS,
        parameter(
            "diff_trans",
            "float or texture",
            "0",
            "How much diffuse light passes: from 0 (none) over 1 (half) to 2 (all).",
        ),
        parameter(
            "diffuse_reflectance_sampling_rate",
            "float",
            "1",
            "How often diffuse reflection is sampled, relative to the other lobes. The rates \
             change the noise, not the picture.",
        ),
        parameter(
            "specular_reflectance_sampling_rate",
            "float",
            "1",
            "The same for specular reflection.",
        ),
        parameter(
            "specular_transmittance_sampling_rate",
            "float",
            "1",
            "The same for specular transmission.",
        ),
        parameter(
            "diffuse_transmittance_sampling_rate",
            "float",
            "1",
            "The same for diffuse transmission.",
        ),
    ],
    sample: r#"<bsdf type="principledthin">
    <rgb name="base_color" value="0.7, 0.1, 0.1"/>
    <float name="roughness" value="0.15"/>
    <float name="spec_trans" value="0.8"/>
    <float name="diff_trans" value="0.3"/>
    <float name="eta" value="1.33"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="principledthin"><float name="diff_trans" value="0.7"/><float name="sheen" value="0.3"/></bsdf>"#),
        one_way(r#"<bsdf type="principledthin"><float name="spec_trans" value="0.7"/><float name="diff_trans" value="0.7"/><float name="roughness" value="0.7"/><float name="anisotropic" value="0.5"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="principledthin"><float name="roughness" value="0"/><float name="spec_trans" value="1"/><float name="eta" value="0.001"/><float name="diff_trans" value="2"/></bsdf>"#,
    ],
    batched: &[],
};

/// Disney's material for thin sheets.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThin {
    base: BaseParameters,
    eta: ScalarSource,
    diff_trans: ScalarSource,
    rates: Rates,
}

/// Relative sampling rates of the lobes.
#[derive(Clone, Copy, Debug)]
struct Rates {
    diffuse_reflection: f32,
    specular_reflection: f32,
    specular_transmission: f32,
    diffuse_transmission: f32,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<PrincipledThin> {
    Some(PrincipledThin {
        base: BaseParameters::read(builder, parameters, ScalarSource::Constant(0.0)),
        eta: scalar_within(builder, parameters, "eta", 1.5, 1e-3..=1e3),
        diff_trans: scalar_within(builder, parameters, "diff_trans", 0.0, 0.0..=2.0),
        rates: Rates {
            diffuse_reflection: sampling_rate(parameters, "diffuse_reflectance_sampling_rate"),
            specular_reflection: sampling_rate(parameters, "specular_reflectance_sampling_rate"),
            specular_transmission: sampling_rate(
                parameters,
                "specular_transmittance_sampling_rate",
            ),
            diffuse_transmission: sampling_rate(parameters, "diffuse_transmittance_sampling_rate"),
        },
    })
}

impl ClosureMaterial for PrincipledThin {
    type Closure<'a> = PrincipledThinClosure<'a>;

    fn transmits(&self) -> bool {
        true
    }

    /// Reads the textures at a hit. Not inlined, like the closure's functions: rare code must not
    /// bloat the loops that all materials share.
    #[inline(never)]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> PrincipledThinClosure<'a> {
        PrincipledThinClosure {
            base: self.base.resolve(textures, surface),
            eta: limited(self.eta.eval(textures, surface), 1e-3, 1e3),
            passing: 0.5 * limited(self.diff_trans.eval(textures, surface), 0.0, 2.0),
            rates: &self.rates,
        }
    }
}

/// Disney's material for thin sheets, resolved.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThinClosure<'a> {
    base: Base,
    eta: f32,
    /// The fraction of diffuse light that is transmitted.
    passing: f32,
    rates: &'a Rates,
}

/// One number per lobe.
#[derive(Clone, Copy)]
struct Lobes {
    specular_reflection: f32,
    specular_transmission: f32,
    diffuse_reflection: f32,
    diffuse_transmission: f32,
}

/// The vector mirrored to the other side of the sheet.
#[inline]
fn through(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.y, -v.z)
}

impl PrincipledThinClosure<'_> {
    /// The distribution of normals for transmission. The sheet refracts light twice, so the spread
    /// shrinks as the index approaches one (Burley 2015, figure 15).
    #[inline]
    fn passing_normals(&self) -> Microfacets {
        self.base.microfacets(0.65 * self.eta - 0.35)
    }

    /// The value and density for `wi` above the sheet and `wo` on either side.
    fn eval_pdf_above(&self, wi: Vec3, wo: Vec3) -> (Spectrum, f32) {
        // The half vector; for transmission, `wo` is mirrored first.
        let reflected = Vec3::new(wo.x, wo.y, wo.z.abs());
        let m = (wi + reflected).normalize_or_zero();
        if wo.z > 0.0 { self.reflection(wi, wo, m) } else { self.transmission(wi, wo, m) }
    }

    fn reflection(&self, wi: Vec3, wo: Vec3, m: Vec3) -> (Spectrum, f32) {
        let cos_d = wi.dot(m);
        let base = self.base.diffuse(wi.z, wo.z, cos_d) + self.base.sheen(wo.z, cos_d);
        let share = (1.0 - self.base.spec_trans) * (1.0 - self.passing);
        let mut value = base * share;
        let lobes = self.probabilities();
        let mut pdf = lobes.diffuse_reflection * cosine_hemisphere::pdf(wo);
        if self.base.spec_trans > 0.0 {
            let clear = fresnel::dielectric(cos_d, self.eta).reflectance;
            let normal = self.base.hue() * normal_reflectance(self.eta);
            let tint = schlick(normal, cos_d, self.eta);
            let tint = Spectrum::splat(clear).lerp(tint, self.base.spec_tint);
            let mirror = self.base.microfacets(1.0).reflection(wi, wo, m);
            value += tint * (self.base.spec_trans * mirror.value);
            pdf += lobes.specular_reflection * mirror.pdf;
        }
        (value, pdf)
    }

    fn transmission(&self, wi: Vec3, wo: Vec3, m: Vec3) -> (Spectrum, f32) {
        let lobes = self.probabilities();
        let share = (1.0 - self.base.spec_trans) * self.passing;
        let mut value = self.base.color * (share * FRAC_1_PI * -wo.z);
        let mut pdf = lobes.diffuse_transmission * cosine_hemisphere::pdf(-wo);
        // As in Mitsuba, nothing is transmitted if the microfacet hides the far side.
        if self.base.spec_trans > 0.0 && wo.dot(m) < 0.0 {
            let share = 1.0 - fresnel::dielectric(wi.dot(m), self.eta).reflectance;
            let mirror = self.passing_normals().reflection(wi, through(wo), m);
            value += self.base.color * (self.base.spec_trans * share * mirror.value);
            pdf += lobes.specular_transmission * mirror.pdf;
        }
        (value, pdf)
    }

    /// The probabilities of the lobes; all zero if there is nothing to sample.
    #[inline]
    fn probabilities(&self) -> Lobes {
        let (rates, specular) = (self.rates, 0.5 * self.base.spec_trans);
        let diffuse = 1.0 - self.base.spec_trans;
        let weights = Lobes {
            specular_reflection: specular * rates.specular_reflection,
            specular_transmission: specular * rates.specular_transmission,
            diffuse_reflection: diffuse * (1.0 - self.passing) * rates.diffuse_reflection,
            diffuse_transmission: diffuse * self.passing * rates.diffuse_transmission,
        };
        let total = weights.specular_reflection
            + weights.specular_transmission
            + weights.diffuse_reflection
            + weights.diffuse_transmission;
        let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
        Lobes {
            specular_reflection: weights.specular_reflection * scale,
            specular_transmission: weights.specular_transmission * scale,
            diffuse_reflection: weights.diffuse_reflection * scale,
            diffuse_transmission: weights.diffuse_transmission * scale,
        }
    }

    /// Samples a direction for `wi` above the sheet.
    fn sample_above(&self, wi: Vec3, lobe: f32, uniform: Vec2) -> Option<(Vec3, Lobe)> {
        let lobes = self.probabilities();
        let mut remaining = lobe;
        let mut chosen = |probability: f32| {
            let here = remaining < probability;
            remaining -= probability;
            here
        };
        if chosen(lobes.specular_reflection) {
            let m = self.base.microfacets(1.0).sample(wi, uniform);
            let wo = fresnel::reflect(wi, m.into());
            return (wo.z > 0.0).then_some((wo, Lobe::Smooth));
        }
        if chosen(lobes.specular_transmission) {
            let m = Vec3::from(self.passing_normals().sample(wi, uniform));
            let wo = through(fresnel::reflect(wi, m));
            return (wo.z < 0.0 && wo.dot(m) < 0.0).then_some((wo, Lobe::Smooth));
        }
        let wo = cosine_hemisphere::sample(uniform);
        if chosen(lobes.diffuse_reflection) {
            return Some((wo, Lobe::Smooth));
        }
        // If rounding selects a lobe that does not exist, its density is zero and the sample fails.
        Some((-wo, Lobe::Smooth))
    }
}

impl Closure for PrincipledThinClosure<'_> {
    #[inline(never)]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, _transport: Transport) -> (Spectrum, f32) {
        if wi.z == 0.0 || wo.z == 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let side = wi.z.signum();
        let (value, pdf) = self.eval_pdf_above(wi * side, wo * side);
        // Densities at grazing microfacets may overflow.
        if value.is_finite() && pdf.is_finite() { (value, pdf) } else { (Spectrum::ZERO, 0.0) }
    }

    #[inline(never)]
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        if wi.z == 0.0 {
            return None;
        }
        let side = wi.z.signum();
        let (wo, lobe) = self.sample_above(wi * side, lobe, direction)?;
        let wo = wo * side;
        let (value, pdf) = self.eval_pdf(wi, wo, transport);
        (pdf > 0.0).then(|| BsdfSample { wo, weight: value / pdf, pdf, eta: 1.0, lobe })
    }

    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, _wi: Vec3) -> Spectrum {
        self.base.color
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::Transport;
    use crate::testing::material::TestMaterial;
    use etendue_testkit::TestRng;

    #[test]
    fn both_sides_are_the_same() {
        let sheet = TestMaterial::read(
            r#"<bsdf type="principledthin"><float name="spec_trans" value="0.5"/>
               <float name="diff_trans" value="0.7"/><float name="anisotropic" value="0.4"/></bsdf>"#,
        );
        let mut random = TestRng::new(11);
        for _ in 0..200 {
            let (wi, wo) = (random.unit_vector(), random.unit_vector());
            let value = |sign: f32| {
                sheet.bsdf(wi * sign).eval_pdf(wi * sign, wo * sign, Transport::Radiance)
            };
            assert_eq!(value(1.0), value(-1.0));
        }
    }

    #[test]
    fn the_diffuse_light_goes_to_the_side_that_is_asked_for() {
        let passed = |diff_trans: f32| {
            let sheet = TestMaterial::read(&format!(
                r#"<bsdf type="principledthin"><float name="diff_trans" value="{diff_trans}"/></bsdf>"#
            ));
            let bsdf = sheet.bsdf(glam::Vec3::Z);
            [glam::Vec3::Z, -glam::Vec3::Z]
                .map(|wo| bsdf.eval_pdf(glam::Vec3::Z, wo, Transport::Radiance).0[0])
        };
        let half = 0.5 * std::f32::consts::FRAC_1_PI;
        assert_eq!(passed(0.0)[1], 0.0);
        assert_eq!(passed(2.0)[0], 0.0);
        assert!((passed(2.0)[1] - half).abs() < 1e-6);
    }
}
