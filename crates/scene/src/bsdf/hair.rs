//! `hair`: light that scatters at a hair fibre, with any number of internal reflections.

use super::dielectric::EXT_IOR;
use super::{BsdfSample, Closure, ClosureMaterial, Lobe, Transport};
use crate::builder::Builder;
use crate::interaction::SurfaceInteraction;
use crate::manual::{Manual, parameter};
use crate::models::bsdf_inputs::rough_relative_index;
use crate::models::fresnel;
#[cfg(test)]
use crate::testing::bsdf_cases::{Cases, Configuration, one_way};
use crate::texture::{ColorSource, Textures};
use etendue_document::{Fault, Parameters};
use etendue_math::safe_sqrt;
use etendue_spectrum::{Spectrum, SpectrumUse};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_8, PI, TAU};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Hair and fur, for curves (Chiang et al., *A Practical and Controllable Hair and Fur \
              Model for Production Path Tracing*, 2016): reflection, transmission, and light that \
              comes out again after bounces inside, all at the point where the hair was met. \
              Brown without parameters.",
    parameters: &[
        parameter("eumelanin", "float", "1.3", "The concentration of the dark pigment."),
        parameter("pheomelanin", "float", "0.2", "The concentration of the reddish pigment."),
        parameter(
            "sigma_a",
            "spectrum or texture",
            "",
            "The absorption inside, per radius of the hair; instead of the pigments.",
        ),
        parameter("scale", "float", "1", "A factor on `sigma_a`."),
        parameter(
            "int_ior",
            "float or string",
            "amber",
            "The index of refraction of the hair: a number, or a name.",
        ),
        EXT_IOR,
        parameter(
            "longitudinal_roughness",
            "float",
            "0.3",
            "The roughness along the hair, from 0 to 1.",
        ),
        parameter("azimuthal_roughness", "float", "0.3", "The roughness around it, from 0 to 1."),
        parameter(
            "scale_tilt",
            "float",
            "2",
            "How much the scales of the hair stand off, in degrees: highlights are shifted by it.",
        ),
    ],
    sample: r#"<bsdf type="hair">
    <float name="eumelanin" value="0.2"/>
    <float name="pheomelanin" value="0.4"/>
</bsdf>"#,
};

/// Configurations for the tests of all materials.
#[cfg(test)]
#[rustfmt::skip]
pub(crate) const CASES: Cases = Cases {
    usual: &[
        one_way(r#"<bsdf type="hair"/>"#),
        one_way(r#"<bsdf type="hair"><rgb name="sigma_a" value="0.1, 0.2, 0.5"/><float name="longitudinal_roughness" value="0.6"/><float name="azimuthal_roughness" value="0.8"/><float name="scale_tilt" value="5"/></bsdf>"#),
        Configuration { lossless: true, ..one_way(r#"<bsdf type="hair"><float name="sigma_a" value="0"/></bsdf>"#) },
    ],
    extreme: &[
        r#"<bsdf type="hair"><float name="longitudinal_roughness" value="0"/><float name="azimuthal_roughness" value="0"/><float name="sigma_a" value="1e30"/></bsdf>"#,
        r#"<bsdf type="hair"><float name="longitudinal_roughness" value="1"/><float name="azimuthal_roughness" value="1"/><float name="scale_tilt" value="90"/></bsdf>"#,
    ],
    batched: &[],
};

/// The number of separate scattering terms, by segments inside the hair: none (reflection), one,
/// two. The last term collects all further ones.
const TERMS: usize = 4;

/// Absorption of unit pigment concentrations, per hair radius (d'Eon et al., "An Energy-Conserving
/// Hair Reflectance Model", 2011).
const EUMELANIN: Spectrum = Spectrum::from_rgb([0.419, 0.697, 1.37]);
const PHEOMELANIN: Spectrum = Spectrum::from_rgb([0.187, 0.4, 1.05]);

/// Hair.
#[derive(Clone, Copy, Debug)]
pub struct Hair {
    absorption: ColorSource,
    absorption_scale: f32,
    fiber: Fiber,
}

/// The constants of a fibre.
#[derive(Clone, Copy, Debug)]
struct Fiber {
    eta: f32,
    /// The inverse variance of the longitudinal lobe of each term.
    concentrations: [f32; TERMS],
    /// The scale of the logistic distribution around the hair.
    azimuthal_scale: f32,
    /// The angles by which the cuticle scales tilt the first three terms: sine and cosine.
    tilts: [(f32, f32); TERMS - 1],
}

/// Reads the parameters.
pub fn build(builder: &mut Builder<'_>, parameters: &Parameters<'_>) -> Option<Hair> {
    let concentration = |name, default| parameters.float_in(name, default, 0.0..=1e6) as f32;
    let eumelanin = concentration("eumelanin", 1.3);
    let pheomelanin = concentration("pheomelanin", 0.2);
    let absorption_scale = parameters.float_in("scale", 1.0, 0.0..=1e9) as f32;
    let given = builder.optional_color(parameters, "sigma_a", SpectrumUse::Unbounded);
    if given.is_some() && (parameters.has("eumelanin") || parameters.has("pheomelanin")) {
        let message = "give either `sigma_a` or pigments";
        parameters.error(Fault::BadValue, "sigma_a", message);
    }
    let pigments = EUMELANIN * eumelanin + PHEOMELANIN * pheomelanin;
    let roughness = |name| parameters.float_in(name, 0.3, 0.0..=1.0) as f32;
    let (along, around) = (roughness("longitudinal_roughness"), roughness("azimuthal_roughness"));
    let tilt = parameters.float_in("scale_tilt", 2.0, -90.0..=90.0) as f32;
    let eta = rough_relative_index(builder, parameters, "amber")?;
    Some(Hair {
        absorption: given.unwrap_or(ColorSource::Constant(pigments)),
        absorption_scale: if given.is_some() { absorption_scale } else { 1.0 },
        fiber: Fiber::new(eta, Vec2::new(along, around), tilt),
    })
}

impl Fiber {
    /// Chiang et al., section 4.1: roughness along and around the hair, and the tilt in degrees.
    fn new(eta: f32, roughness: Vec2, tilt: f32) -> Self {
        let Vec2 { x: along, y: around } = roughness;
        let deviation = 0.726 * along + 0.812 * along * along + 3.7 * along.powi(20);
        // The directions' precision cannot resolve sharper lobes.
        let variance = (deviation * deviation).max(1e-5);
        let variances = [variance, 0.25 * variance, 4.0 * variance, 4.0 * variance];
        let scale =
            FRAC_PI_8.sqrt() * (0.265 * around + 1.194 * around * around + 5.372 * around.powi(22));
        let tilt = tilt.to_radians();
        Self {
            eta,
            concentrations: variances.map(|variance| 1.0 / variance),
            azimuthal_scale: scale.max(1e-4),
            // Reflection is tilted by −2α, and each further segment adds α: Marschner et al. 2003,
            // table 1.
            tilts: [-2.0 * tilt, tilt, 4.0 * tilt].map(f32::sin_cos),
        }
    }
}

impl ClosureMaterial for Hair {
    type Closure<'a> = HairClosure<'a>;

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
    ) -> HairClosure<'a> {
        let absorption = self.absorption.eval(textures, surface) * self.absorption_scale;
        // A texture may contain any value.
        HairClosure { absorption: absorption.clamp(0.0, 1e30), fiber: &self.fiber }
    }
}

/// Resolved hair. The y axis of the local frame runs along the hair.
#[derive(Clone, Copy, Debug)]
pub struct HairClosure<'a> {
    absorption: Spectrum,
    fiber: &'a Fiber,
}

/// A direction in the fibre's angles.
#[derive(Clone, Copy)]
struct FiberDirection {
    /// The sine and cosine of the angle to the plane across the hair.
    sin_theta: f32,
    cos_theta: f32,
    /// The angle around the hair.
    phi: f32,
}

impl FiberDirection {
    fn new(v: Vec3) -> Self {
        Self { sin_theta: v.y, cos_theta: v.x.hypot(v.z), phi: v.z.atan2(v.x) }
    }

    /// The same direction, tilted along the hair by the angle with this sine and cosine.
    fn tilted(self, (sine, cosine): (f32, f32)) -> Self {
        Self {
            sin_theta: self.sin_theta * cosine + self.cos_theta * sine,
            cos_theta: (self.cos_theta * cosine - self.sin_theta * sine).abs(),
            phi: self.phi,
        }
    }
}

/// How light from one direction passes through the fibre.
struct Passage<'a> {
    fiber: &'a Fiber,
    wi: FiberDirection,
    /// The angle between the direction and the normal in the cross-section, outside and inside.
    gamma_i: f32,
    gamma_t: f32,
    /// The fraction of light that leaves in each term.
    attenuation: [Spectrum; TERMS],
}

impl<'a> Passage<'a> {
    fn new(closure: &HairClosure<'a>, wi: Vec3) -> Self {
        let fiber = closure.fiber;
        let gamma_i = -wi.x.atan2(wi.z);
        let wi = FiberDirection::new(wi);
        let sin2_theta = wi.sin_theta * wi.sin_theta;
        // Bravais' law: in the cross-section, light refracts as if the index were higher.
        let projected = (fiber.eta * fiber.eta - sin2_theta).max(1e-12).sqrt();
        let sin_gamma_t = (gamma_i.sin() * wi.cos_theta / projected).clamp(-1.0, 1.0);
        let cos_theta_t = safe_sqrt(1.0 - sin2_theta / (fiber.eta * fiber.eta)).max(1e-6);
        let length = 2.0 * safe_sqrt(1.0 - sin_gamma_t * sin_gamma_t) / cos_theta_t;
        let transmitted = (closure.absorption * -length).exp();
        let cosine = wi.cos_theta * gamma_i.cos().abs();
        let reflected = fresnel::dielectric(cosine, fiber.eta).reflectance;
        let entering = 1.0 - reflected;
        let once = transmitted * (entering * entering);
        let twice = once * transmitted * reflected;
        let bounce = transmitted * reflected;
        let rest = (twice * bounce).safe_div(Spectrum::ONE - bounce);
        Self {
            fiber,
            wi,
            gamma_i,
            gamma_t: sin_gamma_t.asin(),
            attenuation: [Spectrum::splat(reflected), once, twice, rest],
        }
    }

    /// The probability of each term; `None` where all light is absorbed.
    fn probabilities(&self) -> Option<[f32; TERMS]> {
        let luminances = self.attenuation.map(Spectrum::luminance);
        let total: f32 = luminances.iter().sum();
        (total > 0.0).then(|| luminances.map(|luminance| luminance / total))
    }

    /// The direction at the centre of a term's longitudinal lobe.
    fn incident(&self, term: usize) -> FiberDirection {
        self.fiber.tilts.get(term).map_or(self.wi, |&tilt| self.wi.tilted(tilt))
    }

    /// The azimuth by which a smooth hair would deflect the light.
    fn turn(&self, term: usize) -> f32 {
        let term = term as f32;
        2.0 * term * self.gamma_t - 2.0 * self.gamma_i + term * PI
    }

    /// The density of a term's direction in solid angle.
    fn density(&self, term: usize, wo: FiberDirection) -> f32 {
        let along = longitudinal(self.fiber.concentrations[term], self.incident(term), wo);
        if term == TERMS - 1 {
            return along / TAU;
        }
        let off = wo.phi - self.wi.phi - self.turn(term);
        along * trimmed_logistic(off, self.fiber.azimuthal_scale)
    }

    fn eval_pdf(&self, wo: Vec3) -> (Spectrum, f32) {
        let wo = FiberDirection::new(wo);
        let Some(probabilities) = self.probabilities() else { return (Spectrum::ZERO, 0.0) };
        let (mut value, mut pdf) = (Spectrum::ZERO, 0.0);
        for (term, (share, probability)) in self.attenuation.iter().zip(probabilities).enumerate() {
            let density = self.density(term, wo);
            value += *share * density;
            pdf += probability * density;
        }
        (value, pdf)
    }

    fn sample(&self, lobe: f32, uniform: Vec2) -> Option<Vec3> {
        let probabilities = self.probabilities()?;
        let (mut term, mut remaining) = (0, lobe);
        while term + 1 < TERMS && remaining >= probabilities[term] {
            remaining -= probabilities[term];
            term += 1;
        }
        let reused = (remaining / probabilities[term]).clamp(0.0, 1.0 - f32::EPSILON);
        let (sin_theta, cos_theta) =
            sample_longitudinal(self.fiber.concentrations[term], self.incident(term), uniform);
        let turn = match term {
            3 => TAU * reused,
            _ => self.turn(term) + sample_trimmed_logistic(reused, self.fiber.azimuthal_scale),
        };
        let (sin_phi, cos_phi) = (self.wi.phi + turn).sin_cos();
        Vec3::new(cos_theta * cos_phi, sin_theta, cos_theta * sin_phi).try_normalize()
    }
}

/// The longitudinal density, which integrates to one with the weight cos θo.
///
/// d'Eon et al. 2011, equation 7, with the exponentials combined so that none overflows.
fn longitudinal(concentration: f32, wi: FiberDirection, wo: FiberDirection) -> f32 {
    let cosines = wi.cos_theta * wo.cos_theta;
    let sines = wi.sin_theta * wo.sin_theta;
    let exponential = (concentration * (cosines - sines - 1.0)).exp();
    let normalisation = concentration / (1.0 - (-2.0 * concentration).exp());
    normalisation * exponential * scaled_bessel(concentration * cosines)
}

/// Samples the sine and cosine of θo with that density; d'Eon et al., "Importance Sampling for
/// Physically-Based Hair Fiber Models", 2013.
fn sample_longitudinal(concentration: f32, wi: FiberDirection, uniform: Vec2) -> (f32, f32) {
    let floor = (-2.0 * concentration).exp();
    let cosine = 1.0 + (uniform.x + (1.0 - uniform.x) * floor).ln() / concentration;
    let cosine = cosine.clamp(-1.0, 1.0);
    let sine = safe_sqrt(1.0 - cosine * cosine) * (TAU * uniform.y).cos();
    let sin_theta = (sine * wi.cos_theta - cosine * wi.sin_theta).clamp(-1.0, 1.0);
    (sin_theta, safe_sqrt(1.0 - sin_theta * sin_theta))
}

/// e⁻ˣ I₀(x) for x ≥ 0: Abramowitz and Stegun, *Handbook of Mathematical Functions*, 9.8.1 and
/// 9.8.2.
fn scaled_bessel(x: f32) -> f32 {
    const NEAR: [f32; 7] =
        [1.0, 3.515_622_9, 3.089_942_4, 1.206_749_2, 0.265_973_2, 0.036_076_8, 0.004_581_3];
    const FAR: [f32; 9] = [
        0.398_942_3,
        0.013_285_92,
        0.002_253_19,
        -0.001_575_65,
        0.009_162_81,
        -0.020_577_06,
        0.026_355_37,
        -0.016_476_33,
        0.003_923_77,
    ];
    let polynomial =
        |coefficients: &[f32], t: f32| coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c);
    if x < 3.75 {
        let t = x / 3.75;
        (-x).exp() * polynomial(&NEAR, t * t)
    } else {
        polynomial(&FAR, 3.75 / x) / x.sqrt()
    }
}

/// The logistic density truncated to ±π. The angle may be of any size.
fn trimmed_logistic(angle: f32, scale: f32) -> f32 {
    let angle = (angle - TAU * (angle / TAU).round()).abs();
    let exponential = (-angle / scale).exp();
    let whole = exponential / (scale * (1.0 + exponential) * (1.0 + exponential));
    whole / (0.5 * PI / scale).tanh()
}

/// Samples an angle with that density.
fn sample_trimmed_logistic(uniform: f32, scale: f32) -> f32 {
    let lowest = 1.0 / (1.0 + (PI / scale).exp());
    let share = lowest + uniform * (0.5 * PI / scale).tanh();
    (-scale * (1.0 / share - 1.0).ln()).clamp(-PI, PI)
}

impl Closure for HairClosure<'_> {
    #[inline(never)]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, _transport: Transport) -> (Spectrum, f32) {
        Passage::new(self, wi).eval_pdf(wo)
    }

    #[inline(never)]
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        _transport: Transport,
    ) -> Option<BsdfSample> {
        let passage = Passage::new(self, wi);
        let wo = passage.sample(lobe, direction)?;
        let (value, pdf) = passage.eval_pdf(wo);
        let sample = || BsdfSample { wo, weight: value / pdf, pdf, eta: 1.0, lobe: Lobe::Smooth };
        (pdf > 0.0 && pdf.is_finite()).then(sample)
    }

    fn has_smooth_lobe(&self) -> bool {
        true
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        Passage::new(self, wi).attenuation.into_iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::material::{TestMaterial, assert_finds};
    use etendue_document::Severity;
    use etendue_testkit::quadrature::integrate_gauss;

    #[test]
    fn the_bessel_function_has_its_tabulated_values() {
        // Abramowitz and Stegun, table 9.8.
        let table = [(0.0, 1.0), (0.1, 0.907_100_9), (1.0, 0.465_759_6), (5.0, 0.183_540_8)];
        for (x, expected) in table {
            assert!((scaled_bessel(x) - expected).abs() < 2e-7, "{x}: {}", scaled_bessel(x));
        }
        // The expansion for large arguments: (1 + 1 / 8x + 9 / 128x²) / √(2πx).
        let x = 500.0_f32;
        let expected = (1.0 + 0.125 / x + 9.0 / (128.0 * x * x)) / (TAU * x).sqrt();
        assert!((scaled_bessel(x) / expected - 1.0).abs() < 1e-6);
    }

    #[test]
    fn lobes_integrate_to_one() {
        for scale in [0.05_f32, 0.3, 2.0] {
            let total = integrate_gauss(
                |angle| f64::from(trimmed_logistic(angle as f32, scale)),
                f64::from(-PI),
                f64::from(PI),
                400,
            );
            assert!((total - 1.0).abs() < 1e-4, "{scale}: {total}");
        }
        for (concentration, theta) in [(0.3, 0.7), (5.0, -1.0), (80.0, 0.2)] {
            let at = |theta: f64| FiberDirection {
                sin_theta: theta.sin() as f32,
                cos_theta: theta.cos() as f32,
                phi: 0.0,
            };
            let density = |angle: f64| f64::from(longitudinal(concentration, at(theta), at(angle)));
            let total = integrate_gauss(
                |angle| density(angle) * angle.cos(),
                -std::f64::consts::FRAC_PI_2,
                std::f64::consts::FRAC_PI_2,
                400,
            );
            assert!((total - 1.0).abs() < 1e-4, "{concentration} {theta}: {total}");
        }
    }

    #[test]
    fn without_parameters_it_is_brown() {
        let brown = TestMaterial::read(r#"<bsdf type="hair"/>"#);
        let [red, green, blue] = brown.bsdf(Vec3::Z).albedo(Vec3::Z).rgb();
        assert!(red > green && green > blue);
        let pigments = EUMELANIN * 1.3 + PHEOMELANIN * 0.2;
        assert!((pigments[0] - 0.5821).abs() < 1e-6, "{pigments:?}");
    }

    #[test]
    fn pigments_and_absorption_exclude_each_other() {
        assert_finds(
            r#"<bsdf type="hair"><rgb name="sigma_a" value="1, 2, 3"/><float name="eumelanin" value="1"/></bsdf>"#,
            Severity::Error,
            Fault::BadValue,
            "either",
        );
    }
}
