//! `principled`: Disney's material, which covers metal, plastic and glass.

use super::dielectric::radiance_scale;
use super::{BsdfSample, Closure, ClosureMaterial, Lobe, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::{fraction, limited};
use crate::models::disney::{
    ANISOTROPIC, BASE_COLOR, Base, BaseParameters, CoatNormals, FLATNESS, ROUGHNESS, SHEEN,
    SHEEN_TINT, SPEC_TINT, normal_reflectance, sampling_rate, schlick, share_at, strength,
};
use crate::models::fresnel;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, plain};
use crate::texture::{ScalarSource, Textures};
use etendue_document::{Fault, Parameters};
use etendue_sampling::warp::cosine_hemisphere;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Many materials in one, by parameters from 0 to 1: metal, plastic, glass, cloth, and \
              a clear coat over them (Burley, *Physically Based Shading at Disney*, 2012, and \
              *Extending the Disney BRDF to a BSDF*, 2015). Black from behind, unless it transmits.",
    parameters: &[
        BASE_COLOR,
        ROUGHNESS,
        ANISOTROPIC,
        parameter("metallic", "float or texture", "0", "From dielectric (0) to metal (1)."),
        parameter("spec_trans", "float or texture", "0", "From opaque (0) to glass (1)."),
        parameter("eta", "float", "", "The index of refraction inside over outside."),
        parameter(
            "specular",
            "float",
            "0.5",
            "Instead of `eta`: the reflection at normal incidence over 0.08, from 0 to 1.",
        ),
        SPEC_TINT,
        SHEEN,
        SHEEN_TINT,
        FLATNESS,
        parameter("clearcoat", "float or texture", "0", "The strength of the clear coat, 0 to 1."),
        parameter(
            "clearcoat_gloss",
            "float or texture",
            "0",
            "From a satin coat (0) to gloss (1).",
        ),
        parameter(
            "main_specular_sampling_rate",
            "float",
            "1",
            "How often the specular lobe is sampled, relative to the others. The rates change the \
             noise, not the picture.",
        ),
        parameter("clearcoat_sampling_rate", "float", "1", "The same for the clear coat."),
        parameter(
            "diffuse_reflectance_sampling_rate",
            "float",
            "1",
            "The same for the diffuse lobe.",
        ),
    ],
    sample: r#"<bsdf type="principled">
    <rgb name="base_color" value="0.9, 0.6, 0.3"/>
    <float name="metallic" value="0.7"/>
    <float name="specular" value="0.6"/>
    <float name="roughness" value="0.2"/>
    <float name="clearcoat" value="0.6"/>
    <float name="clearcoat_gloss" value="0.3"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="principled"/>"#),
        plain(r#"<bsdf type="principled"><float name="metallic" value="0.8"/><float name="roughness" value="0.3"/><float name="anisotropic" value="0.7"/><float name="spec_tint" value="0.5"/></bsdf>"#),
        plain(r#"<bsdf type="principled"><float name="clearcoat" value="1"/><float name="roughness" value="0.8"/><float name="flatness" value="0.7"/><float name="sheen" value="0.5"/><float name="sheen_tint" value="0.5"/></bsdf>"#),
        plain(r#"<bsdf type="principled"><float name="spec_trans" value="0.8"/><float name="roughness" value="0.6"/><float name="clearcoat" value="0.5"/><float name="eta" value="1.4"/></bsdf>"#),
        plain(r#"<bsdf type="principled"><float name="spec_trans" value="1"/><float name="base_color" value="1"/><float name="eta" value="0.8"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="principled"><float name="roughness" value="0"/><float name="anisotropic" value="1"/><float name="clearcoat" value="10000"/><float name="clearcoat_gloss" value="1"/></bsdf>"#,
        r#"<bsdf type="principled"><float name="roughness" value="0"/><float name="spec_trans" value="1"/><float name="eta" value="1000"/></bsdf>"#,
    ],
    batched: &[],
};

/// Disney's material.
#[derive(Clone, Copy, Debug)]
pub struct Principled {
    base: BaseParameters,
    eta: f32,
    clearcoat: ScalarSource,
    clearcoat_gloss: ScalarSource,
    rates: Rates,
}

/// Relative sampling rates of the lobes.
#[derive(Clone, Copy, Debug)]
struct Rates {
    specular: f32,
    clearcoat: f32,
    diffuse: f32,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Principled> {
    let metallic = fraction(builder, parameters, "metallic", 0.0);
    let base = BaseParameters::read(builder, parameters, metallic);
    let eta = relative_index(parameters, base.transmits());
    if eta == 1.0 && !matches!(metallic, ScalarSource::Constant(0.0)) {
        let name = if parameters.has("eta") { "eta" } else { "specular" };
        let message =
            "with an index of refraction of 1, the metallic part reflects nothing, as in Mitsuba";
        parameters.warning(Fault::BadValue, name, message);
    }
    Some(Principled {
        base,
        eta,
        clearcoat: strength(builder, parameters, "clearcoat"),
        clearcoat_gloss: fraction(builder, parameters, "clearcoat_gloss", 0.0),
        rates: Rates {
            specular: sampling_rate(parameters, "main_specular_sampling_rate"),
            clearcoat: sampling_rate(parameters, "clearcoat_sampling_rate"),
            diffuse: sampling_rate(parameters, "diffuse_reflectance_sampling_rate"),
        },
    })
}

/// The index from `eta` or `specular`. A rough interface between equal indices would transmit in
/// one direction only. If the material transmits, the indices are kept slightly apart.
fn relative_index(parameters: &Parameters<'_>, transmits: bool) -> f32 {
    let specular = parameters.float_in("specular", 0.5, 0.0..=1.0) as f32;
    if parameters.has("eta") {
        if parameters.has("specular") {
            let message = "give either `eta` or `specular`: one follows from the other";
            parameters.error(Fault::BadValue, "specular", message);
        }
        let eta = parameters.float_in("eta", 1.5, 1e-3..=1e3) as f32;
        return if transmits && eta == 1.0 { 1.001 } else { eta };
    }
    let specular = if transmits && specular == 0.0 { 1e-3 } else { specular };
    2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0
}

impl ClosureMaterial for Principled {
    type Closure<'a> = PrincipledClosure<'a>;

    fn transmits(&self) -> bool {
        self.base.transmits()
    }

    /// Reads the textures at a hit. Not inlined, like the closure's functions: rare code must not
    /// bloat the loops that all materials share.
    #[inline(never)]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> PrincipledClosure<'a> {
        PrincipledClosure {
            base: self.base.resolve(textures, surface),
            clearcoat: limited(self.clearcoat.eval(textures, surface), 0.0, 1e4),
            coat: CoatNormals::new(share_at(&self.clearcoat_gloss, textures, surface)),
            material: self,
        }
    }
}

/// Disney's material, resolved.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledClosure<'a> {
    base: Base,
    clearcoat: f32,
    coat: CoatNormals,
    /// The parameters that do not vary.
    material: &'a Principled,
}

/// The surface seen from the side of `wi`, which is above it.
struct Facing<'a> {
    closure: &'a PrincipledClosure<'a>,
    wi: Vec3,
    /// Whether that side is outside.
    front: bool,
    /// The index below over the index above.
    eta: f32,
}

/// The probabilities of the lobes, given the fraction `reflected` that the main one reflects.
struct Choice {
    diffuse: f32,
    clearcoat: f32,
    transmission: f32,
    reflection: f32,
}

impl PrincipledClosure<'_> {
    /// Flips directions so that `wi` is above. The factor converts them in both ways.
    #[inline]
    fn facing(&self, wi: Vec3) -> Option<(Facing<'_>, f32)> {
        let front = wi.z > 0.0;
        // From behind, light can only leave through glass.
        if wi.z == 0.0 || !front && self.glass() == 0.0 {
            return None;
        }
        let inside = self.material.eta;
        let (side, eta) = if front { (1.0, inside) } else { (-1.0, 1.0 / inside) };
        Some((Facing { closure: self, wi: wi * side, front, eta }, side))
    }

    /// The weight of the opaque dielectric.
    #[inline]
    fn opaque(&self) -> f32 {
        (1.0 - self.base.metallic) * (1.0 - self.base.spec_trans)
    }

    /// The weight of glass.
    #[inline]
    fn glass(&self) -> f32 {
        (1.0 - self.base.metallic) * self.base.spec_trans
    }
}

impl Facing<'_> {
    /// `None` if there is nothing to sample. The sum of the weights does not depend on the
    /// microfacet, so evaluation finds the same probabilities for the same normal.
    #[inline]
    fn choice(&self, reflected: f32) -> Option<Choice> {
        let closure = self.closure;
        let transmitted = closure.glass() * (1.0 - reflected);
        let Rates { specular, clearcoat, diffuse } = closure.material.rates;
        let choice = if self.front {
            Choice {
                diffuse: closure.opaque() * diffuse,
                clearcoat: 0.25 * closure.clearcoat * clearcoat,
                transmission: specular * transmitted,
                reflection: specular * (1.0 - transmitted),
            }
        } else {
            Choice {
                diffuse: 0.0,
                clearcoat: 0.0,
                transmission: 1.0 - reflected,
                reflection: reflected,
            }
        };
        let total = choice.diffuse + choice.clearcoat + choice.transmission + choice.reflection;
        (total > 0.0).then(|| Choice {
            diffuse: choice.diffuse / total,
            clearcoat: choice.clearcoat / total,
            transmission: choice.transmission / total,
            reflection: choice.reflection / total,
        })
    }

    /// The normal of the microfacets that scatter light to `wo`, above the surface.
    #[inline]
    fn normal(&self, wo: Vec3) -> Option<Vec3> {
        let relative = if wo.z > 0.0 { 1.0 } else { self.eta };
        let m = (self.wi + wo * relative).normalize_or_zero();
        let m = if m.z < 0.0 { -m } else { m };
        (self.wi.dot(m) > 0.0 && wo.dot(m) * wo.z > 0.0).then_some(m)
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, transport: Transport) -> Option<(Spectrum, f32)> {
        let m = self.normal(wo)?;
        let reflected = fresnel::dielectric(self.wi.dot(m), self.eta).reflectance;
        let choice = self.choice(reflected);
        let (value, pdf) = if wo.z > 0.0 {
            self.reflection(wo, m, reflected, choice)
        } else {
            self.transmission(wo, m, reflected, choice, transport)
        };
        // The Jacobians overflow at grazing microfacets.
        (value.is_finite() && pdf.is_finite()).then_some((value, pdf))
    }

    fn reflection(
        &self,
        wo: Vec3,
        m: Vec3,
        reflected: f32,
        choice: Option<Choice>,
    ) -> (Spectrum, f32) {
        let closure = self.closure;
        let (wi, cos_d) = (self.wi, self.wi.dot(m));
        let main = closure.base.microfacets(1.0).reflection(wi, wo, m);
        let mut value = Spectrum::ZERO;
        // As in Mitsuba, equal indices mean no reflection at all, not even from metal.
        if reflected > 0.0 {
            value = self.tint(reflected, cos_d) * main.value;
        }
        let coat = closure.coat.density(m);
        if self.front {
            let dielectric = 1.0 - closure.base.metallic;
            value += closure.base.diffuse(wi.z, wo.z, cos_d) * closure.opaque()
                + closure.base.sheen(wo.z, cos_d) * dielectric;
        }
        if self.front && closure.clearcoat > 0.0 {
            let fresnel = schlick(Spectrum::splat(0.04), cos_d, self.eta);
            let masked = coat * CoatNormals::masking(wi, wo) * wo.z;
            value += fresnel * (0.25 * closure.clearcoat * masked);
        }
        let pdf = choice.map_or(0.0, |choice| {
            choice.reflection * main.pdf
                + choice.diffuse * cosine_hemisphere::pdf(wo)
                + choice.clearcoat * coat * m.z / (4.0 * cos_d)
        });
        (value, pdf)
    }

    /// Walter et al. 2007, equation 21 and the density after equation 17.
    fn transmission(
        &self,
        wo: Vec3,
        m: Vec3,
        reflected: f32,
        choice: Option<Choice>,
        transport: Transport,
    ) -> (Spectrum, f32) {
        let closure = self.closure;
        let microfacets = closure.base.microfacets(1.0);
        let (cos_i, cos_o) = (self.wi.dot(m), wo.dot(m).abs());
        let root = cos_i - self.eta * cos_o;
        let jacobian = self.eta * self.eta * cos_o / (root * root);
        let masking = microfacets.masking_over_cosine(self.wi)
            * (microfacets.masking_over_cosine(wo) * -wo.z);
        let share = closure.glass() * (1.0 - reflected);
        let value = microfacets.density(m) * masking * cos_i * jacobian * share;
        // The light crosses two such interfaces. Each takes the square root of the colour.
        let tint = closure.base.color.sqrt() * radiance_scale(1.0 / self.eta, transport);
        let pdf = choice.map_or(0.0, |choice| choice.transmission);
        (tint * value, pdf * microfacets.pdf(self.wi, m) * jacobian)
    }

    /// The fraction that the main lobe reflects: Fresnel's equations for the clear part, Schlick's
    /// approximation for the metallic part and for the tint of the base colour.
    #[inline]
    fn tint(&self, reflected: f32, cosine: f32) -> Spectrum {
        let closure = self.closure;
        if !self.front {
            return Spectrum::splat(closure.glass() * reflected);
        }
        let dielectric = 1.0 - closure.base.metallic;
        let tinted = dielectric * closure.base.spec_tint;
        let mut tint = Spectrum::splat((dielectric - tinted) * reflected);
        if closure.base.metallic > 0.0 {
            tint += schlick(closure.base.color, cosine, self.eta) * closure.base.metallic;
        }
        if tinted > 0.0 {
            let normal = closure.base.hue() * normal_reflectance(self.eta);
            tint += schlick(normal, cosine, self.eta) * tinted;
        }
        tint
    }

    #[inline]
    fn sample_direction(&self, lobe: f32, uniform: Vec2) -> Option<(Vec3, f32, Lobe)> {
        let m = Vec3::from(self.closure.base.microfacets(1.0).sample(self.wi, uniform));
        let interface = fresnel::dielectric(self.wi.dot(m), self.eta);
        let choice = self.choice(interface.reflectance)?;
        let mut remaining = lobe;
        let mut chosen = |probability: f32| {
            let here = remaining < probability;
            remaining -= probability;
            here
        };
        Some(if chosen(choice.diffuse) {
            (cosine_hemisphere::sample(uniform), 1.0, Lobe::Smooth)
        } else if chosen(choice.clearcoat) {
            (fresnel::reflect(self.wi, self.closure.coat.sample(uniform)), 1.0, Lobe::Smooth)
        } else if chosen(choice.transmission) {
            (fresnel::refract(self.wi, m, &interface), self.eta, Lobe::Smooth)
        } else {
            (fresnel::reflect(self.wi, m), 1.0, Lobe::Smooth)
        })
    }
}

impl Closure for PrincipledClosure<'_> {
    #[inline(never)]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32) {
        self.facing(wi)
            .and_then(|(facing, side)| facing.eval_pdf(wo * side, transport))
            .unwrap_or((Spectrum::ZERO, 0.0))
    }

    #[inline(never)]
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let (facing, side) = self.facing(wi)?;
        let (wo, eta, lobe) = facing.sample_direction(lobe, direction)?;
        // Light that would need a second microfacet is lost.
        if wo.z == 0.0 || (wo.z < 0.0) != (eta != 1.0) {
            return None;
        }
        let (value, pdf) = facing.eval_pdf(wo, transport)?;
        (pdf > 0.0).then(|| BsdfSample { wo: wo * side, weight: value / pdf, pdf, eta, lobe })
    }

    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        if self.facing(wi).is_some() { self.base.color } else { Spectrum::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use crate::bsdf::Transport;
    use crate::testing::material::{TestMaterial, assert_finds, assert_same};
    use etendue_document::{Fault, Severity};
    use glam::Vec3;

    #[test]
    fn specular_and_eta_say_the_same() {
        // 0.08 · 0.5 = 0.04 = ((1.5 − 1) / (1.5 + 1))².
        assert_same(
            r#"<bsdf type="principled"><float name="specular" value="0.5"/></bsdf>"#,
            r#"<bsdf type="principled"/>"#,
        );
        let value = |parameter: &str| {
            let material = TestMaterial::read(&format!(
                r#"<bsdf type="principled"><float name="roughness" value="0.3"/>{parameter}</bsdf>"#
            ));
            let wi = Vec3::new(0.3, 0.0, 0.9).normalize();
            material.bsdf(wi).eval_pdf(wi, Vec3::Z, Transport::Radiance).0[0]
        };
        let eta = value(r#"<float name="eta" value="1.5"/>"#);
        assert!((eta - value(r#"<float name="specular" value="0.5"/>"#)).abs() < 1e-5 * eta);
    }

    #[test]
    fn eta_and_specular_together_are_refused() {
        assert_finds(
            r#"<bsdf type="principled"><float name="eta" value="1.5"/><float name="specular" value="0.5"/></bsdf>"#,
            Severity::Error,
            Fault::BadValue,
            "either",
        );
    }

    #[test]
    fn parameters_out_of_range_are_limited_aloud() {
        for name in ["roughness", "metallic", "spec_trans", "flatness", "clearcoat_gloss"] {
            assert_finds(
                &format!(r#"<bsdf type="principled"><float name="{name}" value="1.5"/></bsdf>"#),
                Severity::Warning,
                Fault::BadValue,
                name,
            );
        }
    }

    #[test]
    fn it_is_black_from_behind_unless_it_transmits() {
        let seen = |spec_trans: f32| {
            let material = TestMaterial::read(&format!(
                r#"<bsdf type="principled"><float name="spec_trans" value="{spec_trans}"/></bsdf>"#
            ));
            let wi = -Vec3::Z;
            material.bsdf(wi).eval_pdf(wi, Vec3::Z, Transport::Radiance).0[0]
        };
        assert_eq!(seen(0.0), 0.0);
        assert!(seen(0.5) > 0.0);
    }
}
