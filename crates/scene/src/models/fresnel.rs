//! Fresnel's equations for dielectrics and conductors, and the reflected and refracted directions.

use etendue_math::lanes::{Real, Vector3};
use etendue_spectrum::SpectrumLanes;
use glam::Vec3;

/// What happens to light at a smooth interface between two dielectrics.
#[derive(Clone, Copy, Debug)]
pub struct Interface<R = f32> {
    /// The fraction of unpolarised light that is reflected.
    pub reflectance: R,
    /// The cosine of the refracted direction. Its sign is opposite to that of the incident one; it
    /// is zero under total internal reflection.
    pub cos_theta_t: R,
    /// The index on the far side over the index on the side of the incident direction.
    pub eta_it: R,
    /// The inverse of [`eta_it`](Self::eta_it).
    pub eta_ti: R,
}

/// Light that hits the interface at the signed cosine `cos_theta_i`. `eta` is the index on the
/// negative side over the index on the positive side.
///
/// Born and Wolf, *Principles of Optics*, section 1.5.2.
#[inline(always)]
#[must_use]
pub fn dielectric<R: Real>(cos_theta_i: R, eta: R) -> Interface<R> {
    let (zero, one) = (eta.zero(), eta.like(1.0));
    let outside = cos_theta_i.ge(zero);
    let inverse = one / eta;
    let (eta_it, eta_ti) = (R::select(outside, eta, inverse), R::select(outside, inverse, eta));
    // Snell's law for the squared cosine; negative under total internal reflection.
    let sin_theta_i_squared = one - cos_theta_i * cos_theta_i;
    let cos_theta_t_squared = one - sin_theta_i_squared * (eta_ti * eta_ti);
    let cos_i = cos_theta_i.abs();
    let cos_t = cos_theta_t_squared.safe_sqrt();
    let perpendicular = (cos_i - eta_it * cos_t) / (cos_i + eta_it * cos_t);
    let parallel = (cos_t - eta_it * cos_i) / (cos_t + eta_it * cos_i);
    // Rounding may push the mean of two ones above one.
    let mean = ((perpendicular * perpendicular + parallel * parallel) * 0.5).min(one);
    let reflectance = R::select(cos_i.equals(zero), one, mean);
    let reflectance = R::select(eta.equals(one), zero, reflectance);
    Interface { reflectance, cos_theta_t: R::select(outside, -cos_t, cos_t), eta_it, eta_ti }
}

/// The fraction of unpolarised light that a conductor of index `eta` + i·`k` reflects at the cosine
/// `cos_theta_i` in [0, 1].
///
/// Lazányi and Szirmay-Kalos, "Fresnel Term Approximations for Metals", WSCG 2005, equations 2 and
/// 3.
#[inline(always)]
#[must_use]
pub fn conductor<R: Real>(
    cos_theta_i: R,
    eta: SpectrumLanes<R>,
    k: SpectrumLanes<R>,
) -> SpectrumLanes<R> {
    let cos2 = cos_theta_i * cos_theta_i;
    let sin2 = -cos2 + 1.0;
    let (eta2, k2) = (eta * eta, k * k);
    let difference = eta2 - k2 - SpectrumLanes::grey(sin2);
    // a² + b² of the paper's complex root a + i·b, and a itself.
    let modulus = (difference * difference + eta2 * k2 * cos2.like(4.0)).sqrt();
    let half = cos2.like(0.5);
    let real = ((modulus + difference) * half).clamp(0.0, f32::INFINITY).sqrt();
    let cross = real * (cos_theta_i * 2.0);
    let sum = modulus + SpectrumLanes::grey(cos2);
    let perpendicular = (sum - cross).safe_div(sum + cross);
    let sum = modulus * cos2 + SpectrumLanes::grey(sin2 * sin2);
    let cross = cross * sin2;
    let parallel = perpendicular * (sum - cross).safe_div(sum + cross);
    ((perpendicular + parallel) * half).clamp(0.0, 1.0)
}

/// The fraction of perfectly diffuse light that a smooth interface reflects: 2 ∫ F(μ) μ dμ. If
/// `eta` > 1, the light comes from the side of lower index.
///
/// The closed form of Walsh ("The Reflection Factor of a Polished Glass Surface for Diffused
/// Light", 1926) as given by Dunkle. From inside, 1 − F is that from outside divided by η², because
/// étendue is the same in both directions.
#[must_use]
pub fn diffuse_reflectance(eta: f32) -> f32 {
    let eta = f64::from(eta);
    if eta < 1.0 {
        return (1.0 - (1.0 - walsh(1.0 / eta)) * (eta * eta)) as f32;
    }
    walsh(eta) as f32
}

fn walsh(n: f64) -> f64 {
    // Closer to one, the terms, which grow as 1 / (n − 1), cancel to noise. The result is then
    // below 3e-6.
    if n < 1.0 + 1e-5 {
        return 0.0;
    }
    let (n2, n3, n4) = (n * n, n * n * n, n * n * n * n);
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n3 * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
}

/// The mirror image of `wi` about the unit vector `m`.
#[inline(always)]
#[must_use]
pub fn reflect(wi: Vec3, m: Vec3) -> Vec3 {
    reflect_lanes::<f32>(wi.into(), m.into()).into()
}

/// [`reflect`] over any [`Real`].
#[inline(always)]
#[must_use]
pub fn reflect_lanes<R: Real>(wi: Vector3<R>, m: Vector3<R>) -> Vector3<R> {
    m * (wi.dot(m) * 2.0) - wi
}

/// The mirror image of `wi` about the surface normal.
#[inline(always)]
pub(crate) fn mirror<R: Real>(wi: Vector3<R>) -> Vector3<R> {
    Vector3::new(-wi.x, -wi.y, wi.z)
}

/// `wi` refracted at the unit normal `m`, on either side; `interface` is [`dielectric`] at wi·m.
#[inline(always)]
#[must_use]
pub fn refract(wi: Vec3, m: Vec3, interface: &Interface) -> Vec3 {
    refract_lanes::<f32>(wi.into(), m.into(), interface).into()
}

/// [`refract`] over any [`Real`].
#[inline(always)]
#[must_use]
pub fn refract_lanes<R: Real>(
    wi: Vector3<R>,
    m: Vector3<R>,
    interface: &Interface<R>,
) -> Vector3<R> {
    let along = wi.dot(m) * interface.eta_ti + interface.cos_theta_t;
    // Refraction scales the rounding errors of `wi` by the index.
    (m * along - wi * interface.eta_ti).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_spectrum::Spectrum;
    use etendue_testkit::quadrature::integrate_gauss;

    fn conductor(cosine: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
        super::conductor(cosine, eta.into(), k.into()).into()
    }

    #[test]
    fn normal_incidence_has_the_textbook_value() {
        for eta in [1.5_f32, 1.0 / 1.5, 2.4] {
            let expected = ((eta - 1.0) / (eta + 1.0)).powi(2);
            for cosine in [1.0, -1.0] {
                assert!((dielectric(cosine, eta).reflectance - expected).abs() < 1e-7);
            }
        }
        let silver = conductor(1.0, Spectrum::splat(0.155), Spectrum::splat(3.6));
        let expected = ((0.155 - 1.0_f32).powi(2) + 3.6 * 3.6) / (1.155_f32.powi(2) + 3.6 * 3.6);
        assert!((silver.max_component() - expected).abs() < 1e-6);
    }

    #[test]
    fn brewster_grazing_and_total_reflection() {
        let eta = 1.5_f32;
        // At Brewster's angle only perpendicularly polarised light is reflected.
        let brewster = dielectric(1.0 / (1.0 + eta * eta).sqrt(), eta).reflectance;
        let perpendicular = (1.0 - eta * eta) / (1.0 + eta * eta);
        assert!((brewster - 0.5 * perpendicular * perpendicular).abs() < 1e-6);
        assert_eq!(dielectric(0.0, eta).reflectance, 1.0);
        let inside = dielectric(-0.5, eta);
        assert_eq!((inside.reflectance, inside.cos_theta_t), (1.0, 0.0));
        assert_eq!(dielectric(0.3, 1.0).reflectance, 0.0);
    }

    #[test]
    fn a_conductor_that_does_not_absorb_is_a_dielectric() {
        for cosine in [0.05, 0.3, 0.7, 1.0] {
            let metal = conductor(cosine, Spectrum::splat(1.8), Spectrum::ZERO);
            assert!((metal[0] - dielectric(cosine, 1.8).reflectance).abs() < 2e-6);
        }
        assert_eq!(conductor(0.4, Spectrum::ZERO, Spectrum::ONE), Spectrum::ONE);
        let nothing = conductor(0.0, Spectrum::ONE, Spectrum::ZERO);
        assert!(nothing.is_finite(), "{nothing:?}");
    }

    #[test]
    fn refraction_follows_snell_there_and_back() {
        let wi = Vec3::new(0.6, -0.3, 0.5).normalize();
        for (wi, eta) in [(wi, 1.5), (wi, 0.9), (-wi, 0.8)] {
            let interface = dielectric(wi.z, eta);
            let wo = refract(wi, Vec3::Z, &interface);
            assert!((wo.length() - 1.0).abs() < 1e-6);
            assert!((wo.z - interface.cos_theta_t).abs() < 1e-6);
            assert!((wo.truncate() * interface.eta_it + wi.truncate()).length() < 1e-6);
            let back = refract(wo, Vec3::Z, &dielectric(wo.z, eta));
            assert!((back - wi).length() < 1e-5, "{back} {wi}");
        }
        assert_eq!(reflect(wi, Vec3::Z), Vec3::new(-wi.x, -wi.y, wi.z));
    }

    #[test]
    fn the_closed_form_is_the_integral() {
        for eta in [1.001_f32, 1.1, 1.33, 1.489_587_4, 1.9, 2.5, 10.0] {
            // Integrating over x instead of the cosine removes the square-root singularity.
            let integral = |eta: f32, low: f64, high: f64| {
                let integrand = |x: f64| {
                    let cosine = low + (high - low) * x * x;
                    let share = f64::from(dielectric(cosine as f32, eta).reflectance);
                    share * 2.0 * cosine * 2.0 * x * (high - low)
                };
                integrate_gauss(integrand, 0.0, 1.0, 64)
            };
            let outside = integral(eta, 0.0, 1.0);
            assert!((f64::from(diffuse_reflectance(eta)) - outside).abs() < 2e-6, "{eta}");
            let critical = (1.0 - 1.0 / f64::from(eta * eta)).sqrt();
            let inside = critical * critical + integral(1.0 / eta, critical, 1.0);
            assert!((f64::from(diffuse_reflectance(1.0 / eta)) - inside).abs() < 5e-6, "{eta}");
        }
        assert_eq!(diffuse_reflectance(1.0), 0.0);
    }
}
