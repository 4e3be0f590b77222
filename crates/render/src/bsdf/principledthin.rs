//! `principledthin`: Disney's material for sheets: leaves, paper, curtains.

use super::disney::{
    ANISOTROPIC, BASE_COLOR, Base, BaseParameters, FLATNESS, ROUGHNESS, SHEEN, SHEEN_TINT,
    SPEC_TINT, fraction, normal_reflectance, sampling_rate, schlick, share_at,
};
use super::inputs::{limited, scalar_within};
use super::microfacet::Microfacets;
use super::{BsdfSample, Closure, Lobe, Transport, fresnel};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
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

/// Disney's material for sheets.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThin {
    base: BaseParameters,
    spec_trans: ScalarSource,
    eta: ScalarSource,
    diff_trans: ScalarSource,
    rates: Rates,
}

/// How often the lobes are sampled.
#[derive(Clone, Copy, Debug)]
struct Rates {
    diffuse_reflection: f32,
    specular_reflection: f32,
    specular_transmission: f32,
    diffuse_transmission: f32,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<PrincipledThin> {
    let base = BaseParameters::read(builder, parameters);
    Some(PrincipledThin {
        base,
        spec_trans: fraction(builder, parameters, "spec_trans", 0.0),
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

impl PrincipledThin {
    /// Reads the textures at a hit. Out of line, as are the closure's functions: what is rare must
    /// not grow the loops that all materials share.
    #[inline(never)]
    #[must_use]
    pub fn resolve(
        &self,
        textures: Textures<'_>,
        surface: &SurfaceInteraction,
    ) -> PrincipledThinClosure {
        let base = self.base.resolve(textures, surface);
        let spec_trans = share_at(&self.spec_trans, textures, surface);
        let transmitted = 0.5 * limited(self.diff_trans.eval(textures, surface), 0.0, 2.0);
        let diffuse = 1.0 - spec_trans;
        let rates = &self.rates;
        let weights = [
            0.5 * spec_trans * rates.specular_reflection,
            0.5 * spec_trans * rates.specular_transmission,
            diffuse * (1.0 - transmitted) * rates.diffuse_reflection,
            diffuse * transmitted * rates.diffuse_transmission,
        ];
        let total: f32 = weights.iter().sum();
        PrincipledThinClosure {
            base,
            eta: limited(self.eta.eval(textures, surface), 1e-3, 1e3),
            spec_trans,
            diffuse_reflected: diffuse * (1.0 - transmitted),
            diffuse_transmitted: diffuse * transmitted,
            probabilities: weights.map(|weight| if total > 0.0 { weight / total } else { 0.0 }),
        }
    }
}

/// Disney's material for sheets, resolved.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThinClosure {
    base: Base,
    eta: f32,
    spec_trans: f32,
    diffuse_reflected: f32,
    diffuse_transmitted: f32,
    /// Specular reflection and transmission, diffuse reflection and transmission.
    probabilities: [f32; 4],
}

/// The vector on the other side of the sheet.
#[inline]
fn through(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.y, -v.z)
}

impl PrincipledThinClosure {
    /// The normals of what passes: light is bent twice by the sheet, so that it is spread less the
    /// nearer the index is to one (Burley 2015, figure 15).
    #[inline]
    fn passing(&self) -> Microfacets {
        self.base.microfacets(0.65 * self.eta - 0.35)
    }

    /// Value and density for `wi` above the sheet and `wo` on either side.
    fn eval_pdf_above(&self, wi: Vec3, wo: Vec3) -> (Spectrum, f32) {
        // Half way to the mirror image, where light passes.
        let reflected = Vec3::new(wo.x, wo.y, wo.z.abs());
        let m = (wi + reflected).normalize_or_zero();
        if wo.z > 0.0 { self.reflection(wi, wo, m) } else { self.transmission(wi, wo, m) }
    }

    fn reflection(&self, wi: Vec3, wo: Vec3, m: Vec3) -> (Spectrum, f32) {
        let cos_d = wi.dot(m);
        let base = self.base.diffuse(wi.z, wo.z, cos_d) + self.base.sheen(wo.z, cos_d);
        let mut value = base * self.diffuse_reflected;
        let mut pdf = self.probabilities[2] * cosine_hemisphere::pdf(wo);
        if self.spec_trans > 0.0 {
            let clear = fresnel::dielectric(cos_d, self.eta).reflectance;
            let normal = self.base.hue() * normal_reflectance(self.eta);
            let tint = schlick(normal, cos_d, self.eta);
            let tint = Spectrum::splat(clear).lerp(tint, self.base.spec_tint);
            let mirror = self.base.microfacets(1.0).reflection(wi, wo, m);
            value += tint * (self.spec_trans * mirror.value);
            pdf += self.probabilities[0] * mirror.pdf;
        }
        (value, pdf)
    }

    fn transmission(&self, wi: Vec3, wo: Vec3, m: Vec3) -> (Spectrum, f32) {
        let mut value = self.base.color * (self.diffuse_transmitted * FRAC_1_PI * -wo.z);
        let mut pdf = self.probabilities[3] * cosine_hemisphere::pdf(-wo);
        // As in Mitsuba, nothing passes where the microfacet hides the far side.
        if self.spec_trans > 0.0 && wo.dot(m) < 0.0 {
            let share = 1.0 - fresnel::dielectric(wi.dot(m), self.eta).reflectance;
            let mirror = self.passing().reflection(wi, through(wo), m);
            value += self.base.color * (self.spec_trans * share * mirror.value);
            pdf += self.probabilities[1] * mirror.pdf;
        }
        (value, pdf)
    }

    /// A direction for `wi` above the sheet.
    fn sample_above(&self, wi: Vec3, lobe: f32, uniform: Vec2) -> Option<(Vec3, Lobe)> {
        let mut remaining = lobe;
        let chosen = self.probabilities.iter().position(|probability| {
            let here = remaining < *probability;
            remaining -= probability;
            here
        });
        // Rounding may leave a little after the last of them.
        let last = self.probabilities.iter().rposition(|probability| *probability > 0.0)?;
        let wo = match chosen.unwrap_or(last) {
            0 => fresnel::reflect(wi, self.base.microfacets(1.0).sample(wi, uniform)),
            1 => {
                let m = self.passing().sample(wi, uniform);
                let wo = through(fresnel::reflect(wi, m));
                return (wo.z < 0.0 && wo.dot(m) < 0.0).then_some((wo, Lobe::Glossy));
            }
            2 => return Some((cosine_hemisphere::sample(uniform), Lobe::Diffuse)),
            _ => return Some((-cosine_hemisphere::sample(uniform), Lobe::Diffuse)),
        };
        (wo.z > 0.0).then_some((wo, Lobe::Glossy))
    }
}

impl Closure for PrincipledThinClosure {
    #[inline(never)]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, _transport: Transport) -> (Spectrum, f32) {
        if wi.z == 0.0 || wo.z == 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let side = wi.z.signum();
        let (value, pdf) = self.eval_pdf_above(wi * side, wo * side);
        // Densities along grazing microfacets may overflow.
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
    use crate::bsdf::testing::TestMaterial;
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
