//! Conversion of spectral data to linear Rec. 709, as in Mitsuba 3's RGB variants.

use crate::cie::{d65, integrate};
use crate::color::xyz_to_rgb;
use crate::{SampledSpectrum, Spectrum};

/// The meaning of a spectrum in a scene, which determines its illuminant and the valid range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SpectrumUse {
    /// A reflectance, transmittance or albedo: seen under D65, so a constant is grey. Sampled
    /// spectra are clamped to 0..=1.
    Reflectance,
    /// A quantity without an upper bound, such as a scattering coefficient: seen under D65, so a
    /// constant is grey. Sampled spectra are clamped to non-negative values.
    Unbounded,
    /// Emitted light: no illuminant, so a constant is equal-energy white, which is reddish in
    /// Rec. 709 (its white is D65). Sampled spectra are clamped to non-negative values.
    Emission,
    /// The real or imaginary part of a measured index of refraction. Sampled spectra have no
    /// illuminant and are clamped to non-negative values; a constant is equal in all components.
    MeasuredIndex,
}

/// A spectrum as written in a scene.
///
/// ```
/// use etendue_spectrum::{SpectrumUse, SpectrumValue};
///
/// let leaf: SpectrumValue = "400:0.05, 550:0.3, 650:0.05".parse()?;
/// let [red, green, blue] = leaf.to_rgb(SpectrumUse::Reflectance);
/// assert!(green > red && green > blue);
/// # Ok::<(), etendue_spectrum::SpectrumValueError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum SpectrumValue {
    /// The same value at all wavelengths.
    Constant(f32),
    /// Values at given wavelengths.
    Sampled(SampledSpectrum),
}

impl SampledSpectrum {
    /// The linear Rec. 709 colour, clamped to the range of `usage`.
    ///
    /// The same sum over 1000 wavelengths from 360 to 830 nm as in Mitsuba, whose normalisation
    /// gives 0.9989 for a reflectance of 1.
    #[must_use]
    pub fn to_rgb(&self, usage: SpectrumUse) -> [f32; 3] {
        let max = match usage {
            SpectrumUse::Reflectance => 1.0,
            SpectrumUse::Unbounded | SpectrumUse::Emission | SpectrumUse::MeasuredIndex => f32::MAX,
        };
        self.to_rgb_unlimited(usage).map(|component| component.clamp(0.0, max))
    }

    /// The linear Rec. 709 colour without clamping. It differs from [`Self::to_rgb`] if the colour
    /// is out of gamut, which is worth a warning.
    #[must_use]
    pub fn to_rgb_unlimited(&self, usage: SpectrumUse) -> [f32; 3] {
        let rgb = match usage {
            SpectrumUse::Reflectance | SpectrumUse::Unbounded => {
                integrate(|wavelength_nm| self.interpolate(wavelength_nm) * d65(wavelength_nm))
            }
            SpectrumUse::Emission | SpectrumUse::MeasuredIndex => {
                integrate(|wavelength_nm| self.interpolate(wavelength_nm))
            }
        };
        rgb.map(|component| component as f32)
    }
}

impl SpectrumValue {
    /// The linear Rec. 709 colour. Sampled spectra are clamped to the range of `usage`. Constants
    /// are not: their range is checked by the parameter that they belong to.
    #[must_use]
    pub fn to_rgb(&self, usage: SpectrumUse) -> [f32; 3] {
        match self {
            Self::Sampled(samples) => samples.to_rgb(usage),
            Self::Constant(value) => match usage {
                SpectrumUse::Emission => xyz_to_rgb([*value; 3]),
                SpectrumUse::Reflectance | SpectrumUse::Unbounded | SpectrumUse::MeasuredIndex => {
                    [*value; 3]
                }
            },
        }
    }

    /// [`Self::to_rgb`] as a [`Spectrum`].
    #[must_use]
    pub fn to_spectrum(&self, usage: SpectrumUse) -> Spectrum {
        Spectrum::from_rgb(self.to_rgb(usage))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with values that Mitsuba 3.9.1 prints with six digits in variant `scalar_rgb`.
    fn assert_mitsuba(actual: [f32; 3], expected: [f32; 3]) {
        for (a, e) in actual.iter().zip(expected) {
            assert!((a - e).abs() <= 1e-5 * e.abs().max(1.0), "{actual:?} instead of {expected:?}");
        }
    }

    fn sampled(samples: &[(f32, f32)]) -> SampledSpectrum {
        let (wavelengths, values) = samples.iter().copied().unzip();
        SampledSpectrum::new(wavelengths, values).expect("valid samples")
    }

    #[test]
    fn constants_are_grey_except_as_emission() {
        let half = SpectrumValue::Constant(0.5);
        assert_eq!(half.to_rgb(SpectrumUse::Reflectance), [0.5; 3]);
        assert_eq!(SpectrumValue::Constant(2.0).to_rgb(SpectrumUse::Unbounded), [2.0; 3]);
        assert_eq!(half.to_spectrum(SpectrumUse::MeasuredIndex), Spectrum::splat(0.5));
        assert_mitsuba(half.to_rgb(SpectrumUse::Emission), [0.602_397, 0.474_146, 0.454_458]);
    }

    #[test]
    fn sampled_ones_are_white_as_a_reflectance() {
        let white = sampled(&[(360.0, 1.0), (830.0, 1.0)]);
        assert_mitsuba(white.to_rgb(SpectrumUse::Reflectance), [0.998_985, 0.998_874, 0.998_802]);
        assert_mitsuba(white.to_rgb(SpectrumUse::Emission), [1.204_88, 0.948_228, 0.909_267]);
        let wider = sampled(&[(-100.0, 1.0), (9000.0, 1.0)]);
        assert_mitsuba(wider.to_rgb(SpectrumUse::Reflectance), [0.998_985, 0.998_874, 0.998_802]);
    }

    #[test]
    fn sampled_spectra_have_the_colors_of_mitsuba() {
        let ramp = sampled(&[(400.0, 0.1), (500.0, 0.5), (700.0, 0.9)]);
        let under_daylight = [0.775_405, 0.593_508, 0.277_033];
        assert_mitsuba(ramp.to_rgb(SpectrumUse::Reflectance), under_daylight);
        assert_mitsuba(ramp.to_rgb(SpectrumUse::Unbounded), under_daylight);
        assert_mitsuba(ramp.to_rgb(SpectrumUse::Emission), [0.917_922, 0.565_488, 0.241_605]);
    }

    #[test]
    fn colors_out_of_gamut_are_clamped() {
        let bright = sampled(&[(400.0, 3.0), (700.0, 1.0)]);
        assert_eq!(bright.to_rgb(SpectrumUse::Reflectance), [1.0; 3]);
        assert_mitsuba(bright.to_rgb(SpectrumUse::Unbounded), [1.377_73, 2.046_36, 2.712_64]);
        assert_mitsuba(bright.to_rgb(SpectrumUse::Emission), [1.718_47, 1.939_12, 2.482_94]);
        let cyan = sampled(&[(500.0, 1.0), (510.0, 1.0)]);
        assert_mitsuba(cyan.to_rgb(SpectrumUse::Unbounded), [0.0, 0.078_110_8, 0.014_623_2]);
        let unlimited = cyan.to_rgb_unlimited(SpectrumUse::Unbounded);
        assert_mitsuba(unlimited, [-0.072_966_2, 0.078_110_8, 0.014_623_2]);
    }
}
