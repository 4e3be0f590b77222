//! Distributions of microfacet normals: Beckmann and GGX, with Smith's masking.
//!
//! Directions are in the shading frame. Functions that take `wi` require it and the microfacet
//! normal `m` to be above the surface (z > 0).

use super::erf::{erf_given_exponential, erf_inverse};
use crate::lanes::{Columns, Transfer};
use etendue_math::lanes::{Mask as _, Real, Vector2, Vector3};
use glam::Vec2;
use std::f32::consts::FRAC_1_PI;

/// 1/√π.
const FRAC_1_SQRT_PI: f32 = 0.564_189_6;

/// The minimum roughness: a distribution cannot be a delta.
const MIN_ALPHA: f32 = 1e-4;

/// The maximum roughness: above it squares would overflow, and no surface is that rough.
const MAX_ALPHA: f32 = 1e4;

/// Densities below this, times the cosine, count as zero because their quotients would be noise.
const NEGLIGIBLE_DENSITY: f32 = 1e-20;

/// The shape of a distribution of microfacet normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Distribution {
    /// Gaussian slopes (Beckmann and Spizzichino, 1963).
    Beckmann,
    /// The long-tailed distribution of Trowbridge and Reitz (1975), GGX in Walter et al. (2007).
    Ggx,
}

/// Which normals are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSampling {
    /// Those visible from `wi` (Heitz and d'Eon, 2014).
    Visible,
    /// All of them.
    All,
}

/// A distribution of microfacet normals. `R` is a number, or one per lane for several hits that
/// share the distribution and the sampling.
#[derive(Clone, Copy, Debug)]
pub struct Microfacets<R = f32> {
    alpha: Vector2<R>,
    distribution: Distribution,
    sampling: NormalSampling,
}

/// A microfacet reflection without the Fresnel term.
#[derive(Clone, Copy, Debug)]
pub struct MicrofacetReflection<R = f32> {
    /// D·G / (4 cos θi): the value with the cosine.
    pub value: R,
    /// The density of `wo` in solid angle.
    pub pdf: R,
}

impl<R: Real> MicrofacetReflection<R> {
    /// Zero, with as many lanes as `like`.
    #[inline(always)]
    fn nothing(like: R) -> Self {
        Self { value: like.zero(), pdf: like.zero() }
    }
}

impl Microfacets {
    /// Roughness `alpha` along the tangent and the bitangent. For Beckmann it is the root mean
    /// square slope times √2. Values below 1e-4, and NaN, count as 1e-4.
    #[inline]
    #[must_use]
    pub fn new(distribution: Distribution, sampling: NormalSampling, alpha: Vec2) -> Self {
        Self { alpha: alpha.into(), distribution, sampling }.limited()
    }

    /// Any roughness, with sampling of visible normals.
    pub(crate) fn visible(distribution: Distribution) -> Self {
        Self::new(distribution, NormalSampling::Visible, Vec2::ONE)
    }

    /// The distribution with sampling of visible normals.
    pub(crate) fn visible_distribution(&self) -> Option<Distribution> {
        (self.sampling == NormalSampling::Visible).then_some(self.distribution)
    }
}

impl<R: Real> Columns<R> for Microfacets<R> {
    type Over<T: Real, C> = Microfacets<T>;

    const COUNT: usize = 2;

    #[inline(always)]
    fn transfer<T: Real, N: Transfer<R, T>>(self, numbers: &mut N) -> Microfacets<T> {
        let Self { alpha, distribution, sampling } = self;
        let alpha = Vector2::new(numbers.number(alpha.x), numbers.number(alpha.y));
        Microfacets { alpha, distribution, sampling }
    }
}

impl<R: Real> Microfacets<R> {
    /// An isotropic distribution, with sampling of visible normals.
    #[inline(always)]
    pub(crate) fn isotropic(distribution: Distribution, alpha: R) -> Self {
        let (alpha, sampling) = (Vector2::new(alpha, alpha), NormalSampling::Visible);
        Self { alpha, distribution, sampling }.limited()
    }

    /// The distribution with its roughness multiplied by `factor`.
    #[inline(always)]
    #[must_use]
    pub fn scaled(self, factor: R) -> Self {
        Self { alpha: self.alpha * factor, ..self }.limited()
    }

    /// The distribution with its roughness clamped.
    #[inline(always)]
    fn limited(self) -> Self {
        let Vector2 { x, y } = self.alpha;
        // This order maps NaN to the lower bound.
        let limit = |alpha: R| alpha.max(x.like(MIN_ALPHA)).min(x.like(MAX_ALPHA));
        Self { alpha: Vector2::new(limit(x), limit(y)), ..self }
    }

    /// Which normals [`sample`](Self::sample) samples.
    #[inline(always)]
    #[must_use]
    pub fn sampling(&self) -> NormalSampling {
        self.sampling
    }

    /// The distribution D(m) per solid angle; its integral times the cosine is one.
    ///
    /// Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2),
    /// 2014, equations 79 and 85.
    #[inline(always)]
    #[must_use]
    pub fn density(&self, m: impl Into<Vector3<R>>) -> R {
        let (m, alpha) = (m.into(), self.alpha);
        let slope2 = Vector2::new(m.x / alpha.x, m.y / alpha.y).length_squared();
        let cos2 = m.z * m.z;
        let scale = alpha.x.like(FRAC_1_PI) / (alpha.x * alpha.y);
        let density = match self.distribution {
            Distribution::Beckmann => scale * (-slope2 / cos2).exp() / (cos2 * cos2),
            Distribution::Ggx => scale / ((slope2 + cos2) * (slope2 + cos2)),
        };
        // Also false for NaN from 0 / 0.
        R::select((density * m.z).above(NEGLIGIBLE_DENSITY), density, density.zero())
    }

    /// Smith's masking G1(v) / |cos θv|, which stays finite at grazing angles, for v on the visible
    /// side of its microfacet. Beckmann uses the rational fit of Walter et al. 2007, section 5.2,
    /// accurate to 0.35 %. Other renderers use it too, so images agree.
    #[inline(always)]
    #[must_use]
    pub fn masking_over_cosine(&self, v: impl Into<Vector3<R>>) -> R {
        let v = v.into();
        let (cosine, stretched2) = (v.z.abs(), self.stretched_squared(v));
        match self.distribution {
            Distribution::Beckmann => {
                // The paper's a is cosine / sine; its fractions are combined into one.
                let sine = stretched2.sqrt();
                let is_clear = cosine.ge(sine * 1.6);
                let above = sine * 3.535 + cosine * 2.181;
                let below = stretched2 + cosine * (sine * 2.276 + cosine * 2.577);
                R::select(is_clear, cosine.like(1.0), above) / R::select(is_clear, cosine, below)
            }
            Distribution::Ggx => ggx_masking_over_cosine(cosine, stretched2),
        }
    }

    /// G1(v) / |cos θv| without a fit. It normalises the visible normals. With the fit, densities
    /// and estimates that use them would be off by up to 0.35 %.
    #[inline(always)]
    fn exact_masking_over_cosine(&self, v: Vector3<R>) -> R {
        let (cosine, stretched2) = (v.z.abs(), self.stretched_squared(v));
        match self.distribution {
            Distribution::Beckmann => {
                let sine = stretched2.sqrt();
                let a = cosine / sine;
                let exponential = (-a * a).exp();
                // Heitz 2014, equation 82; the exponential is zero where `a` is infinite.
                let below = cosine * (erf_given_exponential(a, exponential) + 1.0)
                    + sine * exponential * FRAC_1_SQRT_PI;
                below.like(2.0) / below
            }
            Distribution::Ggx => ggx_masking_over_cosine(cosine, stretched2),
        }
    }

    /// The squared length of v's tangential part, scaled by the roughness.
    #[inline(always)]
    fn stretched_squared(&self, v: Vector3<R>) -> R {
        (v.truncate() * self.alpha).length_squared()
    }

    /// The density per solid angle of an `m` sampled by [`sample`](Self::sample).
    #[inline(always)]
    #[must_use]
    pub fn pdf(&self, wi: impl Into<Vector3<R>>, m: impl Into<Vector3<R>>) -> R {
        let (wi, m) = (wi.into(), m.into());
        let density = self.density(m);
        match self.sampling {
            NormalSampling::Visible => {
                let cosine = wi.dot(m);
                density * self.exact_masking_over_cosine(wi) * cosine.max(cosine.zero())
            }
            NormalSampling::All => density * m.z,
        }
    }

    /// Reflection from `wi` to `wo`, both above the surface, by microfacets of normal `m` between
    /// them. Zero if `m` is not visible from both.
    #[inline(always)]
    #[must_use]
    pub fn reflection(
        &self,
        wi: impl Into<Vector3<R>>,
        wo: impl Into<Vector3<R>>,
        m: impl Into<Vector3<R>>,
    ) -> MicrofacetReflection<R> {
        let (wi, wo, m) = (wi.into(), wo.into(), m.into());
        let cosine = wi.dot(m);
        let density = self.density(m);
        let is_seen = density.above(0.0) & cosine.above(0.0) & wo.dot(m).above(0.0);
        let nothing = MicrofacetReflection::nothing(cosine);
        if !is_seen.any() {
            return nothing;
        }
        let (masking_i, masking_o) = (self.masking_over_cosine(wi), self.masking_over_cosine(wo));
        let value = density * 0.25 * masking_i * (masking_o * wo.z);
        // The Jacobian of the reflection is 1 / (4 wo·m).
        let pdf = match self.sampling {
            NormalSampling::Visible => density * 0.25 * self.exact_masking_over_cosine(wi),
            NormalSampling::All => density * 0.25 * m.z / cosine,
        };
        // If all normals are sampled, the Jacobian overflows for some of them.
        let exists = is_seen & pdf.is_finite();
        MicrofacetReflection {
            value: R::select(exists, value, nothing.value),
            pdf: R::select(exists, pdf, nothing.pdf),
        }
    }

    /// Samples a microfacet normal. On an isotropic surface, `uniform.y` and 1 − `uniform.y` give
    /// mirror images about the plane of incidence.
    #[inline(always)]
    #[must_use]
    pub fn sample(&self, wi: impl Into<Vector3<R>>, uniform: impl Into<Vector2<R>>) -> Vector3<R> {
        let (wi, uniform) = (wi.into(), uniform.into());
        match (self.sampling, self.distribution) {
            (NormalSampling::All, _) => self.sample_all(uniform),
            (NormalSampling::Visible, Distribution::Ggx) => self.sample_visible_ggx(wi, uniform),
            (NormalSampling::Visible, Distribution::Beckmann) => {
                self.sample_visible_beckmann(wi, uniform)
            }
        }
    }

    /// Both distributions are isotropic in slopes divided by the roughness. The distribution of the
    /// squared length then has a closed-form inverse.
    #[inline(always)]
    fn sample_all(&self, uniform: Vector2<R>) -> Vector3<R> {
        let rest = -uniform.x + 1.0;
        let slope2 = match self.distribution {
            Distribution::Beckmann => -rest.ln(),
            Distribution::Ggx => uniform.x / rest,
        };
        let slope = direction(uniform.y) * slope2.safe_sqrt() * self.alpha;
        slope.extend(rest.like(1.0)).normalize()
    }

    /// Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
    #[inline(always)]
    fn sample_visible_ggx(&self, wi: Vector3<R>, uniform: Vector2<R>) -> Vector3<R> {
        let standard = (wi.truncate() * self.alpha).extend(wi.z).normalize();
        // The height of the cap's point above −standard.z, computed directly because the sum loses
        // precision.
        let height = (-uniform.x + 1.0) * (standard.z + 1.0);
        let z = height - standard.z;
        let disk = direction(uniform.y) * (-z * z + 1.0).safe_sqrt();
        let half = disk + standard.truncate();
        (half * self.alpha).extend(height).normalize()
    }

    /// Jakob, "An Improved Visible Normal Sampling Routine for the Beckmann Distribution", 2014.
    #[inline(always)]
    fn sample_visible_beckmann(&self, wi: Vector3<R>, uniform: Vector2<R>) -> Vector3<R> {
        let standard = (wi.truncate() * self.alpha).extend(wi.z).normalize();
        let sine = standard.truncate().length_squared().sqrt();
        let along = standard.truncate() * sine.reciprocal();
        let x_axis = Vector2::new(sine.like(1.0), sine.zero());
        let along = Vector2::select(sine.above(0.0), along, x_axis);
        let x = visible_beckmann_slope(standard.z, sine, uniform.x);
        let y = erf_inverse(uniform.y * 2.0 - 1.0);
        let slope = Vector2::new(along.x * x - along.y * y, along.y * x + along.x * y) * self.alpha;
        Vector3::new(-slope.x, -slope.y, sine.like(1.0)).normalize()
    }
}

/// The unit vector at an angle given in turns.
#[inline(always)]
fn direction<R: Real>(turns: R) -> Vector2<R> {
    let (sine, cosine) = turns.sin_cos_turn();
    Vector2::new(cosine, sine)
}

/// Heitz 2014, equation 86.
#[inline(always)]
fn ggx_masking_over_cosine<R: Real>(cosine: R, stretched2: R) -> R {
    cosine.like(2.0) / (cosine + (cosine * cosine + stretched2).sqrt())
}

/// Samples the slope along the incident direction of a visible normal of the unit Beckmann
/// distribution. It inverts the cumulative distribution, which in x = erf(slope) is proportional to
/// (1 + x) cos θ + sin θ exp(−slope²) / √π. Newton's iteration in a shrinking bracket; two or three
/// steps suffice. A lane keeps its value once it has converged.
#[inline(always)]
fn visible_beckmann_slope<R: Real>(cosine: R, sine: R, uniform: R) -> R {
    let cotangent = cosine / sine;
    let exponential = (-cotangent * cotangent).exp();
    let highest = erf_given_exponential(cotangent, exponential);
    let total = (highest + 1.0) * cosine + sine * exponential * FRAC_1_SQRT_PI;
    let target = uniform * total;
    // Replacing exp(−slope²) by 1 − x², which differs by at most 0.06, makes the equation quadratic
    // in 1 + x.
    let curvature = sine * FRAC_1_SQRT_PI;
    let linear = cosine + curvature * 2.0;
    let root = (linear * linear - curvature * target * 4.0).safe_sqrt();
    let (mut low, mut high) = (highest.like(-1.0), highest);
    let mut x = (target * 2.0 / (linear + root) - 1.0).min(highest);
    let mut slope = erf_inverse(x);
    // In every lane.
    let mut goes_on = !x.lt(x);
    for _ in 0..10 {
        let value = (x + 1.0) * cosine + curvature * (-slope * slope).exp() - target;
        let is_beyond = value.above(0.0);
        (low, high) = (R::select(is_beyond, low, x), R::select(is_beyond, x, high));
        let newton = x - value / (cosine - slope * sine);
        // Also false for NaN, which occurs if the derivative is zero.
        let inside = newton.ge(low) & newton.le(high);
        let next = R::select(inside, newton, (low + high) * 0.5);
        let step = (next - x).abs();
        x = R::select(goes_on, next, x);
        slope = erf_inverse(x);
        // A step squares the error, or halves it at the upper end, where the density vanishes.
        goes_on = goes_on & step.ge(step.like(1e-4));
        if !goes_on.any() {
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
    use glam::Vec3;

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
                    |random: &mut TestRng| Some(microfacets.sample(wi, random.next_vec2()).into());
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

    /// The visible area of the microfacets equals that of the surface (Heitz 2014, equation 14).
    #[test]
    fn masking_leaves_the_projected_area() {
        for microfacets in distributions() {
            for wi in incident() {
                let exact = microfacets.exact_masking_over_cosine(wi.into());
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
            assert_eq!(Vec2::from(microfacets.alpha), Vec2::splat(MIN_ALPHA));
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
