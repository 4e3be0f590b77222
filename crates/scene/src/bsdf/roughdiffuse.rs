//! `roughdiffuse`: a rough matt surface.

use super::{BsdfSample, Closure, ClosureMaterial, Lobe, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::{limited, reflectance, scalar_within};
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, plain};
use crate::texture::{ColorSource, ScalarSource, Textures};
use etendue_document::Parameters;
use etendue_math::safe_acos;
use etendue_sampling::warp::cosine_hemisphere;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_1_SQRT_2, FRAC_2_PI};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A rough matt surface, such as clay or the moon: flatter than `diffuse`, and brighter \
              towards the light (Oren and Nayar, *Generalization of Lambert's Reflectance Model*, \
              1994). Black from behind; see `twosided`.",
    parameters: &[
        parameter(
            "reflectance",
            "spectrum or texture",
            "0.5",
            "The share of light that each facet scatters. `diffuse_reflectance` is taken too.",
        ),
        parameter(
            "alpha",
            "float or texture",
            "0.2",
            "The roughness: √2 times the standard deviation of the facets' slope in radians.",
        ),
        parameter(
            "use_fast_approx",
            "boolean",
            "false",
            "Whether the short form of the model is used, without light between the facets.",
        ),
    ],
    sample: r#"<bsdf type="roughdiffuse">
    <rgb name="reflectance" value="0.6, 0.5, 0.4"/>
    <float name="alpha" value="0.5"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        plain(r#"<bsdf type="roughdiffuse"><float name="alpha" value="0.5"/></bsdf>"#),
        plain(r#"<bsdf type="roughdiffuse"><boolean name="use_fast_approx" value="true"/></bsdf>"#),
    ],
    extreme: &[
        r#"<bsdf type="roughdiffuse"><float name="alpha" value="10000"/></bsdf>"#,
    ],
    batched: &[],
};

/// The variant of Oren and Nayar's model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// With interreflection between two facets.
    Full,
    /// The fit for single scattering.
    Short,
}

/// A rough matt surface.
#[derive(Clone, Copy, Debug)]
pub struct RoughDiffuse {
    reflectance: ColorSource,
    alpha: ScalarSource,
    form: Form,
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<RoughDiffuse> {
    let name = match parameters.has("reflectance") || !parameters.has("diffuse_reflectance") {
        true => "reflectance",
        false => "diffuse_reflectance",
    };
    let form = match parameters.boolean("use_fast_approx", false) {
        true => Form::Short,
        false => Form::Full,
    };
    Some(RoughDiffuse {
        reflectance: reflectance(builder, parameters, name, 0.5),
        alpha: scalar_within(builder, parameters, "alpha", 0.2, 0.0..=1e4),
        form,
    })
}

impl ClosureMaterial for RoughDiffuse {
    type Closure<'a> = RoughDiffuseClosure;

    fn transmits(&self) -> bool {
        false
    }

    #[inline]
    fn resolve<'a>(
        &'a self,
        textures: Textures<'a>,
        surface: &SurfaceInteraction,
    ) -> RoughDiffuseClosure {
        let alpha = limited(self.alpha.eval(textures, surface), 0.0, 1e4);
        let deviation = alpha * FRAC_1_SQRT_2;
        RoughDiffuseClosure {
            reflectance: self.reflectance.eval(textures, surface),
            variance: deviation * deviation,
            form: self.form,
        }
    }
}

/// A resolved rough matt surface.
#[derive(Clone, Copy, Debug)]
pub struct RoughDiffuseClosure {
    reflectance: Spectrum,
    /// The squared standard deviation of the facets' slope angle.
    variance: f32,
    form: Form,
}

/// A pair of directions in the model's angles: α is the larger polar angle, β the smaller one.
/// Tangents are multiplied by cos θo, which keeps them finite at grazing angles.
struct Angles {
    alpha: f32,
    beta: f32,
    sin_alpha: f32,
    /// The cosine of the azimuth difference; zero if it is undefined.
    cos_phi: f32,
    cos_o: f32,
    /// tan β cos θo.
    tan_beta: f32,
    /// tan((α + β) / 2) cos θo.
    tan_half: f32,
}

impl Angles {
    #[inline]
    fn new(wi: Vec3, wo: Vec3) -> Self {
        let (sin_i, sin_o) = (wi.truncate().length(), wo.truncate().length());
        let product = sin_i * sin_o;
        let cos_phi = if product > 0.0 {
            (wi.truncate().dot(wo.truncate()) / product).clamp(-1.0, 1.0)
        } else {
            0.0
        };
        let (cos_alpha, cos_beta) = (wi.z.min(wo.z), wi.z.max(wo.z));
        let (sin_alpha, sin_beta) = (sin_i.max(sin_o), sin_i.min(sin_o));
        Self {
            alpha: safe_acos(cos_alpha),
            beta: safe_acos(cos_beta),
            sin_alpha,
            cos_phi,
            cos_o: wo.z,
            tan_beta: sin_beta * (wo.z / cos_beta),
            tan_half: (sin_alpha + sin_beta) * (wo.z / (cos_alpha + cos_beta)),
        }
    }
}

impl RoughDiffuseClosure {
    /// π times the value; Oren and Nayar 1994, equation 30.
    #[inline]
    fn short(&self, angles: &Angles) -> Spectrum {
        let variance = self.variance;
        let flat = 1.0 - 0.5 * variance / (variance + 0.33);
        let towards = 0.45 * variance / (variance + 0.09);
        let towards = towards * angles.cos_phi.max(0.0) * angles.sin_alpha;
        self.reflectance * (flat * angles.cos_o + towards * angles.tan_beta)
    }

    /// π times the value; equations 27 to 29.
    #[inline]
    fn full(&self, angles: &Angles) -> Spectrum {
        let variance = self.variance;
        let (alpha, beta) = (angles.alpha * FRAC_2_PI, angles.beta * FRAC_2_PI);
        let c1 = 1.0 - 0.5 * variance / (variance + 0.33);
        let behind = if angles.cos_phi > 0.0 { 0.0 } else { beta * beta * beta };
        let c2 = 0.45 * variance / (variance + 0.09) * (angles.sin_alpha - behind);
        let c3 = 0.125 * variance / (variance + 0.09) * (alpha * beta) * (alpha * beta);
        let c4 = 0.17 * variance / (variance + 0.13);
        let single = c1 * angles.cos_o
            + angles.cos_phi * c2 * angles.tan_beta
            + (1.0 - angles.cos_phi.abs()) * c3 * angles.tan_half;
        let double = c4 * (1.0 - angles.cos_phi * beta * beta) * angles.cos_o;
        self.reflectance * single + self.reflectance * self.reflectance * double
    }
}

impl Closure for RoughDiffuseClosure {
    #[inline]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, _transport: Transport) -> (Spectrum, f32) {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let pdf = cosine_hemisphere::pdf(wo);
        let angles = Angles::new(wi, wo);
        let value = match self.form {
            Form::Full => self.full(&angles),
            Form::Short => self.short(&angles),
        };
        // The fit becomes negative if both directions are grazing.
        ((value * FRAC_1_PI).max(Spectrum::ZERO), pdf)
    }

    #[inline]
    fn sample(
        &self,
        wi: Vec3,
        _lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        if wi.z <= 0.0 {
            return None;
        }
        let wo = cosine_hemisphere::sample(direction);
        let (value, pdf) = self.eval_pdf(wi, wo, transport);
        let sample = || BsdfSample { wo, weight: value / pdf, pdf, eta: 1.0, lobe: Lobe::Smooth };
        (pdf > 0.0).then(sample)
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
    use crate::bsdf::Transport;
    use crate::testing::material::TestMaterial;
    use etendue_testkit::TestRng;
    use glam::Vec3;

    fn value(xml: &str, wi: Vec3, wo: Vec3) -> f32 {
        TestMaterial::read(xml).bsdf(wi).eval_pdf(wi, wo, Transport::Radiance).0[0]
    }

    #[test]
    fn without_roughness_it_is_lamberts() {
        let mut random = TestRng::new(9);
        for form in ["true", "false"] {
            let xml = format!(
                r#"<bsdf type="roughdiffuse"><float name="alpha" value="0"/>
                   <boolean name="use_fast_approx" value="{form}"/></bsdf>"#
            );
            for _ in 0..20 {
                let (wi, wo) = (random.unit_vector(), random.unit_vector());
                let matt = value(r#"<bsdf type="diffuse"/>"#, wi, wo);
                assert!((value(&xml, wi, wo) - matt).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn it_throws_light_back_to_where_it_came_from() {
        let xml = r#"<bsdf type="roughdiffuse"><float name="alpha" value="0.7"/></bsdf>"#;
        let wi = Vec3::new(0.8, 0.0, 0.6);
        let back = value(xml, wi, wi);
        assert!(back > value(r#"<bsdf type="diffuse"/>"#, wi, wi));
        assert!(back > 1.3 * value(xml, wi, Vec3::new(-0.8, 0.0, 0.6)));
    }

    #[test]
    fn the_short_form_has_the_value_of_its_formula() {
        // σ² = 0.125, both at 45°, azimuths equal: A + B sin 45° tan 45°.
        let xml = r#"<bsdf type="roughdiffuse"><float name="alpha" value="0.5"/>
            <boolean name="use_fast_approx" value="true"/></bsdf>"#;
        let wi = Vec3::new(0.5_f32.sqrt(), 0.0, 0.5_f32.sqrt());
        let (a, b) = (1.0 - 0.5 * 0.125 / 0.455, 0.45 * 0.125 / 0.215);
        let cosine = 0.5_f32.sqrt();
        let expected = 0.5 * std::f32::consts::FRAC_1_PI * cosine * (a + b * cosine);
        assert!((value(xml, wi, wi) - expected).abs() < 1e-6);
    }
}
