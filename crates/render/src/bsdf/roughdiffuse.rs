//! `roughdiffuse`: a rough matt surface.

use super::inputs::{reflectance, scalar_within};
use super::{BsdfSample, Closure, Lobe, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::texture::{ColorSource, ScalarSource, Textures};
use etendue_document::Parameters;
use etendue_math::safe_acos;
use etendue_sampling::warp::cosine_hemisphere;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_SQRT_2, FRAC_2_PI};

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

/// Which form of Oren and Nayar's model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// With light that meets two facets.
    Full,
    /// The fit for a single one.
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

impl RoughDiffuse {
    /// Reads the textures at a hit.
    #[inline]
    #[must_use]
    pub fn resolve(
        &self,
        textures: Textures<'_>,
        surface: &SurfaceInteraction,
    ) -> RoughDiffuseClosure {
        // In this order a NaN becomes zero.
        let alpha = self.alpha.eval(textures, surface).max(0.0).min(1e4);
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

/// The angles of a pair of directions as the model names them.
struct Angles {
    /// The sine of the larger polar angle.
    sin_alpha: f32,
    /// The tangent of the smaller polar angle.
    tan_beta: f32,
    /// The cosine of the difference in azimuth; zero where it has none.
    cos_phi: f32,
}

impl Angles {
    fn new(wi: Vec3, wo: Vec3) -> Self {
        let (sin_i, sin_o) = (wi.truncate().length(), wo.truncate().length());
        let product = sin_i * sin_o;
        let cos_phi = if product > 0.0 {
            (wi.truncate().dot(wo.truncate()) / product).clamp(-1.0, 1.0)
        } else {
            0.0
        };
        let (sin_alpha, tan_beta) =
            if wi.z > wo.z { (sin_o, sin_i / wi.z) } else { (sin_i, sin_o / wo.z) };
        Self { sin_alpha, tan_beta, cos_phi }
    }
}

impl RoughDiffuseClosure {
    /// The factor on a Lambertian surface's value; Oren and Nayar 1994, equation 30.
    fn short(&self, angles: &Angles) -> Spectrum {
        let variance = self.variance;
        let flat = 1.0 - 0.5 * variance / (variance + 0.33);
        let towards = 0.45 * variance / (variance + 0.09);
        let factor = flat + towards * angles.cos_phi.max(0.0) * angles.sin_alpha * angles.tan_beta;
        self.reflectance * factor
    }

    /// The same; their equations 27 to 29.
    fn full(&self, wi: Vec3, wo: Vec3, angles: &Angles) -> Spectrum {
        let variance = self.variance;
        let (larger, smaller) = (safe_acos(wi.z.min(wo.z)), safe_acos(wi.z.max(wo.z)));
        let c1 = 1.0 - 0.5 * variance / (variance + 0.33);
        let mut c2 = 0.45 * variance / (variance + 0.09);
        let product = larger * smaller * FRAC_2_PI * FRAC_2_PI;
        let c3 = 0.125 * variance / (variance + 0.09) * product * product;
        let c4 = 0.17 * variance / (variance + 0.13);
        let opposite = smaller * FRAC_2_PI;
        c2 *= match angles.cos_phi > 0.0 {
            true => angles.sin_alpha,
            false => angles.sin_alpha - opposite * opposite * opposite,
        };
        let tan_half = (0.5 * (larger + smaller)).tan();
        let single = c1
            + angles.cos_phi * c2 * angles.tan_beta
            + (1.0 - angles.cos_phi.abs()) * c3 * tan_half;
        let double = c4 * (1.0 - angles.cos_phi * opposite * opposite);
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
        let factor = match self.form {
            Form::Full => self.full(wi, wo, &angles),
            Form::Short => self.short(&angles),
        };
        // The fit dips below zero where both directions graze.
        ((factor * pdf).max(Spectrum::ZERO), pdf)
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
        let sample = || BsdfSample { wo, weight: value / pdf, pdf, eta: 1.0, lobe: Lobe::Diffuse };
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
