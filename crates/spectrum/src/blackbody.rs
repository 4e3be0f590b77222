//! Blackbody emission.

use crate::cie::integrate;

/// Planck's constant in J·s (exact in the SI of 2019).
const PLANCK: f64 = 6.626_070_15e-34;

/// The speed of light in m/s (exact).
const LIGHT_SPEED: f64 = 299_792_458.0;

/// Boltzmann's constant in J/K (exact in the SI of 2019).
const BOLTZMANN: f64 = 1.380_649e-23;

/// The Planck temperature in kelvin. Temperatures are clamped to it, which keeps all results within
/// the range of `f32`.
const MAX_TEMPERATURE: f64 = 1.416_784e32;

const METRES_PER_NANOMETRE: f64 = 1e-9;

/// The spectral radiance of a black body in W·m⁻²·sr⁻¹·nm⁻¹ by Planck's law, at a wavelength in
/// nanometres and a temperature in kelvin.
///
/// Zero if the wavelength or the temperature is not positive or is NaN.
#[must_use]
pub fn blackbody_radiance(wavelength_nm: f64, temperature_kelvin: f64) -> f64 {
    if !(wavelength_nm > 0.0 && temperature_kelvin > 0.0) {
        return 0.0;
    }
    let wavelength = wavelength_nm * METRES_PER_NANOMETRE;
    let exponent =
        PLANCK * LIGHT_SPEED / (wavelength * BOLTZMANN * temperature_kelvin.min(MAX_TEMPERATURE));
    let per_metre =
        2.0 * PLANCK * LIGHT_SPEED * LIGHT_SPEED / (wavelength.powi(5) * exponent.exp_m1());
    per_metre * METRES_PER_NANOMETRE
}

/// The linear Rec. 709 colour of a black body at a temperature in kelvin. Its luminance is
/// [`blackbody_radiance`] weighted by ȳ, as for [`SpectrumUse::Emission`](crate::SpectrumUse).
/// Negative components (blue, below 1900 K) become zero.
///
/// Mitsuba 3 rejects `blackbody` in its RGB variants; this is the result of its spectral ones.
#[must_use]
pub fn blackbody_rgb(temperature_kelvin: f64) -> [f32; 3] {
    let rgb = integrate(|wavelength_nm| blackbody_radiance(wavelength_nm, temperature_kelvin));
    rgb.map(|component| (component as f32).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiance_has_reference_values() {
        // Mitsuba 3's own test of its `blackbody` at 5000 K prints 10997.9 and 11812.
        assert!((blackbody_radiance(456.0, 5000.0) - 10_997.9).abs() < 0.1);
        assert!((blackbody_radiance(700.0, 5000.0) - 11_812.0).abs() < 1.0);
    }

    #[test]
    fn radiance_peaks_at_wiens_wavelength() {
        let peak = 2.897_771_955e6 / 5000.0;
        let at_peak = blackbody_radiance(peak, 5000.0);
        assert!(at_peak > blackbody_radiance(peak - 1.0, 5000.0));
        assert!(at_peak > blackbody_radiance(peak + 1.0, 5000.0));
    }

    #[test]
    fn total_radiance_follows_stefan_and_boltzmann() {
        // ∫ L dλ = σ·T⁴ / π with σ = 5.670 374 419e-8 W·m⁻²·K⁻⁴.
        let temperature: f64 = 3000.0;
        let integral: f64 =
            (0..200_000).map(|i| blackbody_radiance(f64::from(i) + 0.5, 3000.0)).sum();
        let expected = 5.670_374_419e-8 * temperature.powi(4) / std::f64::consts::PI;
        assert!((integral / expected - 1.0).abs() < 1e-4, "{integral} instead of {expected}");
    }

    #[test]
    fn colors_agree_with_spectral_rendering() {
        // A constant emitter rendered by Mitsuba 3.9.1 in `scalar_spectral` with 262144 samples. It
        // divides by a sum of ȳ that is 0.1 % smaller, and its noise is about 2e-4.
        let cases = [
            (3000.0, [733.94, 350.04, 112.81]),
            (5000.0, [15_276.2, 12_096.7, 9_602.0]),
            (6500.0, [43_969.2, 41_457.9, 43_627.8]),
            (10_000.0, [158_554.0, 180_886.2, 260_273.9]),
        ];
        for (temperature, expected) in cases {
            for (actual, e) in blackbody_rgb(temperature).into_iter().zip(expected) {
                assert!((actual * 1.001 / e - 1.0).abs() < 1e-3, "{temperature} K: {actual}, {e}");
            }
        }
    }

    #[test]
    fn negative_components_are_clamped() {
        assert_eq!(blackbody_rgb(1500.0)[2], 0.0);
        assert!(blackbody_rgb(2000.0)[2] > 0.0);
    }

    #[test]
    fn extreme_temperatures_give_finite_colors() {
        for temperature in [0.0, -5.0, f64::NAN, 1e-300, 1.0] {
            assert_eq!(blackbody_rgb(temperature), [0.0; 3], "{temperature}");
        }
        for temperature in [1e12, 1e300, f64::MAX, f64::INFINITY] {
            assert!(blackbody_rgb(temperature).iter().all(|c| c.is_finite()), "{temperature}");
        }
    }
}
