//! Distributions of microfacet normals: Beckmann and GGX, with Smith's masking.
//!
//! Directions are in the shading frame. The functions that take `wi` want it above the surface
//! (z > 0), and the microfacet normal `m` too.

use super::erf::{erf_given_exponential, erf_inverse};
use super::inputs::limited;
use etendue_math::safe_sqrt;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// 1/√π.
const FRAC_1_SQRT_PI: f32 = 0.564_189_6;

/// Roughness below this is raised to it, as a distribution cannot be a delta.
const MIN_ALPHA: f32 = 1e-4;

/// Densities below this, times the cosine, are zero: their quotients would be noise.
const NEGLIGIBLE_DENSITY: f32 = 1e-20;

/// The shape of a distribution of microfacet normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Gaussian slopes (Beckmann and Spizzichino, 1963).
    Beckmann,
    /// The long-tailed distribution of Trowbridge and Reitz (1975), GGX in Walter et al. (2007).
    Ggx,
}

/// Which normals are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSampling {
    /// Those that can be seen from `wi` (Heitz and d'Eon, 2014).
    Visible,
    /// All of them.
    All,
}

/// A distribution of microfacet normals.
#[derive(Clone, Copy, Debug)]
pub struct Microfacets {
    alpha: Vec2,
    distribution: Distribution,
    sampling: NormalSampling,
}

/// A microfacet reflection without its Fresnel term.
#[derive(Clone, Copy, Debug)]
pub struct MicrofacetReflection {
    /// D·G / (4 cos θi): the value with the cosine.
    pub value: f32,
    /// The density of `wo` in solid angle.
    pub pdf: f32,
}

impl Microfacets {
    /// Roughness `alpha` along the tangent and the bitangent: for Beckmann the root mean square of
    /// the slope times √2. Values below 1e-4, and NaN, count as 1e-4.
    #[inline]
    #[must_use]
    pub fn new(distribution: Distribution, sampling: NormalSampling, alpha: Vec2) -> Self {
        // Beyond the upper bound squares would overflow; no surface is that rough.
        let limited = |alpha: f32| limited(alpha, MIN_ALPHA, 1e4);
        Self { alpha: Vec2::new(limited(alpha.x), limited(alpha.y)), distribution, sampling }
    }

    /// The distribution with its roughness multiplied by `factor`.
    #[inline]
    #[must_use]
    pub fn scaled(self, factor: f32) -> Self {
        Self::new(self.distribution, self.sampling, self.alpha * factor)
    }

    /// Which normals [`sample`](Self::sample) chooses from.
    #[inline]
    #[must_use]
    pub fn sampling(&self) -> NormalSampling {
        self.sampling
    }

    /// The distribution D(m) per solid angle; its integral times the cosine is one.
    ///
    /// Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2),
    /// 2014, equations 79 and 85.
    #[inline]
    #[must_use]
    pub fn density(&self, m: Vec3) -> f32 {
        let slope2 = (m.truncate() / self.alpha).length_squared();
        let cos2 = m.z * m.z;
        let scale = FRAC_1_PI / (self.alpha.x * self.alpha.y);
        let density = match self.distribution {
            Distribution::Beckmann => scale * (-slope2 / cos2).exp() / (cos2 * cos2),
            Distribution::Ggx => scale / ((slope2 + cos2) * (slope2 + cos2)),
        };
        // False also for the NaN of 0 / 0.
        if density * m.z > NEGLIGIBLE_DENSITY { density } else { 0.0 }
    }

    /// Smith's masking G1(v) / |cos θv|, which stays finite where v grazes, for v on the visible
    /// side of its microfacet. For Beckmann it holds the rational fit of Walter et al. 2007,
    /// section 5.2, within 0.35 %, as other renderers do, so that pictures agree.
    #[inline]
    #[must_use]
    pub fn masking_over_cosine(&self, v: Vec3) -> f32 {
        let (cosine, stretched2) = (v.z.abs(), self.stretched_squared(v));
        match self.distribution {
            Distribution::Beckmann => {
                let sine = stretched2.sqrt();
                if cosine >= 1.6 * sine {
                    return 1.0 / cosine;
                }
                let a = cosine / sine;
                (3.535 + 2.181 * a) / (sine * (1.0 + 2.276 * a + 2.577 * a * a))
            }
            Distribution::Ggx => ggx_masking_over_cosine(cosine, stretched2),
        }
    }

    /// G1(v) / |cos θv| to the last digits. It normalises the visible normals: with the fit the
    /// densities would be off by up to 0.35 %, and an estimate by them.
    #[inline]
    fn exact_masking_over_cosine(&self, v: Vec3) -> f32 {
        let (cosine, stretched2) = (v.z.abs(), self.stretched_squared(v));
        match self.distribution {
            Distribution::Beckmann => {
                let sine = stretched2.sqrt();
                let a = cosine / sine;
                let exponential = (-a * a).exp();
                // Heitz 2014, equation 82; the exponential is zero where `a` is infinite.
                2.0 / (cosine * (1.0 + erf_given_exponential(a, exponential))
                    + sine * exponential * FRAC_1_SQRT_PI)
            }
            Distribution::Ggx => ggx_masking_over_cosine(cosine, stretched2),
        }
    }

    /// The squared length of v's tangential part, stretched by the roughness.
    #[inline]
    fn stretched_squared(&self, v: Vec3) -> f32 {
        (v.truncate() * self.alpha).length_squared()
    }

    /// The density per solid angle with which [`sample`](Self::sample) gives `m`.
    #[inline]
    #[must_use]
    pub fn pdf(&self, wi: Vec3, m: Vec3) -> f32 {
        let density = self.density(m);
        match self.sampling {
            NormalSampling::Visible => {
                density * self.exact_masking_over_cosine(wi) * wi.dot(m).max(0.0)
            }
            NormalSampling::All => density * m.z,
        }
    }

    /// Reflection from `wi` to `wo`, both above the surface, at the microfacets of normal `m`
    /// between them. Zero where `m` cannot be seen from either.
    #[inline]
    #[must_use]
    pub fn reflection(&self, wi: Vec3, wo: Vec3, m: Vec3) -> MicrofacetReflection {
        let cosine = wi.dot(m);
        let density = self.density(m);
        let nothing = MicrofacetReflection { value: 0.0, pdf: 0.0 };
        if !(density > 0.0 && cosine > 0.0 && wo.dot(m) > 0.0) {
            return nothing;
        }
        let (masking_i, masking_o) = (self.masking_over_cosine(wi), self.masking_over_cosine(wo));
        let value = 0.25 * density * masking_i * (masking_o * wo.z);
        // The Jacobian of the reflection is 1 / (4 wo·m).
        let pdf = match self.sampling {
            NormalSampling::Visible => 0.25 * density * self.exact_masking_over_cosine(wi),
            NormalSampling::All => 0.25 * density * m.z / cosine,
        };
        // Among all normals there are some along which the Jacobian overflows.
        if pdf.is_finite() { MicrofacetReflection { value, pdf } } else { nothing }
    }

    /// Chooses a microfacet normal. For an isotropic surface, `uniform.y` and 1 − `uniform.y` give
    /// mirror images about the plane of incidence.
    #[inline]
    #[must_use]
    pub fn sample(&self, wi: Vec3, uniform: Vec2) -> Vec3 {
        match (self.sampling, self.distribution) {
            (NormalSampling::All, _) => self.sample_all(uniform),
            (NormalSampling::Visible, Distribution::Ggx) => self.sample_visible_ggx(wi, uniform),
            (NormalSampling::Visible, Distribution::Beckmann) => {
                self.sample_visible_beckmann(wi, uniform)
            }
        }
    }

    /// Both distributions are isotropic in slopes that are divided by the roughness; there the
    /// squared length has a closed inverse.
    fn sample_all(&self, uniform: Vec2) -> Vec3 {
        let slope2 = match self.distribution {
            Distribution::Beckmann => -(1.0 - uniform.x).ln(),
            Distribution::Ggx => uniform.x / (1.0 - uniform.x),
        };
        let slope = Vec2::from_angle(TAU * uniform.y) * safe_sqrt(slope2) * self.alpha;
        slope.extend(1.0).normalize()
    }

    /// Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
    fn sample_visible_ggx(&self, wi: Vec3, uniform: Vec2) -> Vec3 {
        let standard = (wi.truncate() * self.alpha).extend(wi.z).normalize();
        // The height of the cap's point above −standard.z; kept, as the sum with it loses digits.
        let height = (1.0 - uniform.x) * (1.0 + standard.z);
        let z = height - standard.z;
        let disk = Vec2::from_angle(TAU * uniform.y) * safe_sqrt(1.0 - z * z);
        let half = disk + standard.truncate();
        (half * self.alpha).extend(height).normalize()
    }

    /// Jakob, "An Improved Visible Normal Sampling Routine for the Beckmann Distribution", 2014.
    fn sample_visible_beckmann(&self, wi: Vec3, uniform: Vec2) -> Vec3 {
        let standard = (wi.truncate() * self.alpha).extend(wi.z).normalize();
        let sine = standard.truncate().length();
        let along = if sine > 0.0 { standard.truncate() / sine } else { Vec2::X };
        let slope = Vec2::new(
            visible_beckmann_slope(standard.z, sine, uniform.x),
            erf_inverse(2.0 * uniform.y - 1.0),
        );
        let slope = along.rotate(slope) * self.alpha;
        (-slope).extend(1.0).normalize()
    }
}

/// Heitz 2014, equation 86.
#[inline]
fn ggx_masking_over_cosine(cosine: f32, stretched2: f32) -> f32 {
    2.0 / (cosine + (cosine * cosine + stretched2).sqrt())
}

/// The slope along the incident direction of a visible normal of the unit Beckmann distribution,
/// by inversion of its cumulative distribution, which in x = erf(slope) is proportional to
/// (1 + x) cos θ + sin θ exp(−slope²) / √π. Newton's iteration within a shrinking bracket; two or
/// three steps do.
fn visible_beckmann_slope(cosine: f32, sine: f32, uniform: f32) -> f32 {
    let cotangent = cosine / sine;
    let exponential = (-cotangent * cotangent).exp();
    let highest = erf_given_exponential(cotangent, exponential);
    let total = (1.0 + highest) * cosine + sine * exponential * FRAC_1_SQRT_PI;
    let target = uniform * total;
    // With 1 − x² for exp(−slope²), which is within 0.06 of it, the equation is quadratic in 1 + x.
    let curvature = sine * FRAC_1_SQRT_PI;
    let linear = cosine + 2.0 * curvature;
    let root = safe_sqrt(linear * linear - 4.0 * curvature * target);
    let (mut low, mut high) = (-1.0, highest);
    let mut x = (2.0 * target / (linear + root) - 1.0).min(highest);
    let mut slope = erf_inverse(x);
    for _ in 0..10 {
        let value = (1.0 + x) * cosine + curvature * (-slope * slope).exp() - target;
        if value > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let newton = x - value / (cosine - slope * sine);
        // False also for NaN, where the derivative is zero.
        let inside = newton >= low && newton <= high;
        let next = if inside { newton } else { 0.5 * (low + high) };
        let step = (next - x).abs();
        x = next;
        slope = erf_inverse(x);
        // A step squares the error, or halves it at the upper end, where the density is zero.
        if step < 1e-4 {
            break;
        }
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::quadrature::integrate_hemisphere;
    use etendue_testkit::{ChiSquare, TestRng};

    fn distributions() -> impl Iterator<Item = Microfacets> {
        [Distribution::Beckmann, Distribution::Ggx].into_iter().flat_map(|distribution| {
            [NormalSampling::Visible, NormalSampling::All].into_iter().flat_map(move |sampling| {
                [Vec2::splat(0.1), Vec2::splat(0.6), Vec2::new(0.5, 0.15)]
                    .map(|alpha| Microfacets::new(distribution, sampling, alpha))
            })
        })
    }

    fn incident() -> [Vec3; 3] {
        [0.0_f32, 50.0, 87.0].map(|degrees| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            Vec3::new(0.8 * sine, -0.6 * sine, cosine)
        })
    }

    #[test]
    fn normals_follow_their_density() {
        let test = ChiSquare { samples: 100_000, ..ChiSquare::one_of(36) };
        for microfacets in distributions() {
            for wi in incident() {
                let sample =
                    |random: &mut TestRng| Some(microfacets.sample(wi, random.next_vec2()));
                let pdf = |m: Vec3| if m.z > 0.0 { microfacets.pdf(wi, m) } else { 0.0 };
                let outcome = test.sphere(sample, pdf);
                assert!(outcome.accepted(), "{microfacets:?} from {wi}: {outcome}");
            }
        }
    }

    #[test]
    fn the_normals_cover_the_surface_once() {
        for microfacets in distributions() {
            let covered = |m: Vec3| f64::from(microfacets.density(m) * m.z);
            let area = integrate_hemisphere(covered, 1e-4);
            assert!((area - 1.0).abs() < 1e-3, "{microfacets:?}: {area}");
        }
    }

    /// What is seen of the microfacets covers what is seen of the surface (Heitz 2014, equation 14).
    #[test]
    fn masking_leaves_the_projected_area() {
        for microfacets in distributions() {
            for wi in incident() {
                let exact = microfacets.exact_masking_over_cosine(wi);
                let seen = |m: Vec3| f64::from(microfacets.density(m) * wi.dot(m).max(0.0));
                let area = integrate_hemisphere(seen, 1e-4) * f64::from(exact);
                assert!((area - 1.0).abs() < 1e-3, "{microfacets:?} from {wi}: {area}");
                let fitted = microfacets.masking_over_cosine(wi);
                assert!((fitted / exact - 1.0).abs() < 3.6e-3, "{microfacets:?} from {wi}");
            }
        }
    }

    #[test]
    fn roughness_is_limited() {
        for alpha in [0.0, -1.0, f32::NAN, 1e-9] {
            let microfacets =
                Microfacets::new(Distribution::Ggx, NormalSampling::Visible, Vec2::splat(alpha));
            assert_eq!(microfacets.alpha, Vec2::splat(MIN_ALPHA));
        }
    }

    #[test]
    fn visible_slopes_invert_their_cumulative_distribution() {
        let mut random = TestRng::new(3);
        for degrees in [0.01_f32, 2.0, 30.0, 60.0, 85.0, 89.9] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let share = |slope: f32| {
                let exponential = (-slope * slope).exp();
                (1.0 + erf_given_exponential(slope, exponential)) * cosine
                    + sine * exponential * FRAC_1_SQRT_PI
            };
            for _ in 0..10_000 {
                let uniform = random.next_f32();
                let slope = visible_beckmann_slope(cosine, sine, uniform);
                let back = share(slope) / share(cosine / sine);
                assert!((back - uniform).abs() < 1e-4, "{degrees}: {uniform} {back}");
            }
        }
    }
}
