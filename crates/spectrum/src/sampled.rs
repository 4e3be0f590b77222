//! [`SampledSpectrum`]: a piecewise linear function of wavelength.

use std::fmt;

/// A spectrum given by samples at increasing wavelengths: linear between them, zero outside.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledSpectrum {
    wavelengths_nm: Vec<f32>,
    values: Vec<f32>,
}

/// A problem with the samples of a [`SampledSpectrum`].
#[derive(Clone, Debug, PartialEq)]
pub enum SampleError {
    /// A wavelength or a value is infinite or NaN.
    NotFinite,
    /// A wavelength is not greater than the one before.
    NotIncreasing,
    /// There are fewer than two samples.
    TooFew,
    /// The numbers of values and wavelengths differ.
    LengthsDiffer,
    /// A sample has no value, or no wavelength.
    Incomplete,
    /// This text, shortened to a few characters, is not a number.
    NotANumber(String),
}

impl SampledSpectrum {
    /// A spectrum from samples in the order of their wavelengths (in nanometres).
    ///
    /// # Errors
    ///
    /// If there are fewer than two samples, if the numbers of wavelengths and values differ, if a
    /// number is not finite, or if the wavelengths do not increase.
    pub fn new(wavelengths_nm: Vec<f32>, values: Vec<f32>) -> Result<Self, SampleError> {
        if wavelengths_nm.len() != values.len() {
            return Err(SampleError::LengthsDiffer);
        }
        let mut spectrum = Self::empty();
        for (wavelength_nm, value) in wavelengths_nm.into_iter().zip(values) {
            spectrum.push(wavelength_nm, value)?;
        }
        spectrum.finish()
    }

    /// The wavelengths of the samples in nanometres: increasing, finite, at least two.
    #[must_use]
    pub fn wavelengths_nm(&self) -> &[f32] {
        &self.wavelengths_nm
    }

    /// The values of the samples, one per wavelength; finite.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The value at a wavelength in nanometres: linear between samples, zero outside of them and at
    /// NaN.
    #[must_use]
    pub fn interpolate(&self, wavelength_nm: f64) -> f64 {
        let above = self.wavelengths_nm.partition_point(|&w| f64::from(w) <= wavelength_nm);
        if above == 0 {
            return 0.0;
        }
        let left = f64::from(self.wavelengths_nm[above - 1]);
        let left_value = f64::from(self.values[above - 1]);
        if above == self.values.len() {
            return if wavelength_nm == left { left_value } else { 0.0 };
        }
        let right = f64::from(self.wavelengths_nm[above]);
        let t = (wavelength_nm - left) / (right - left);
        (1.0 - t) * left_value + t * f64::from(self.values[above])
    }

    /// An empty spectrum to [`push`](Self::push) samples to.
    pub(crate) fn empty() -> Self {
        Self { wavelengths_nm: Vec::new(), values: Vec::new() }
    }

    /// Appends one sample.
    pub(crate) fn push(&mut self, wavelength_nm: f32, value: f32) -> Result<(), SampleError> {
        if !wavelength_nm.is_finite() || !value.is_finite() {
            return Err(SampleError::NotFinite);
        }
        if self.wavelengths_nm.last().is_some_and(|&last| wavelength_nm <= last) {
            return Err(SampleError::NotIncreasing);
        }
        self.wavelengths_nm.push(wavelength_nm);
        self.values.push(value);
        Ok(())
    }

    /// The finished spectrum.
    pub(crate) fn finish(self) -> Result<Self, SampleError> {
        if self.values.len() < 2 { Err(SampleError::TooFew) } else { Ok(self) }
    }
}

impl fmt::Display for SampleError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite => write!(formatter, "a number is not finite"),
            Self::NotIncreasing => write!(formatter, "the wavelengths do not increase"),
            Self::TooFew => write!(formatter, "a spectrum needs at least two samples"),
            Self::LengthsDiffer => {
                write!(formatter, "the numbers of values and wavelengths differ")
            }
            Self::Incomplete => {
                write!(formatter, "a sample needs a wavelength in nanometres and a value")
            }
            Self::NotANumber(text) => write!(formatter, "“{text}” is not a number"),
        }
    }
}

impl std::error::Error for SampleError {}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> SampledSpectrum {
        SampledSpectrum::new(vec![400.0, 500.0, 700.0], vec![1.0, 3.0, -1.0]).expect("valid")
    }

    #[test]
    fn values_between_samples_are_interpolated_linearly() {
        assert_eq!(ramp().interpolate(400.0), 1.0);
        assert_eq!(ramp().interpolate(450.0), 2.0);
        assert_eq!(ramp().interpolate(500.0), 3.0);
        assert_eq!(ramp().interpolate(600.0), 1.0);
        assert_eq!(ramp().interpolate(700.0), -1.0);
    }

    #[test]
    fn values_outside_the_samples_are_zero() {
        for wavelength in [399.999, 700.001, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(ramp().interpolate(wavelength), 0.0);
        }
    }

    #[test]
    fn invalid_samples_are_rejected() {
        let error = |wavelengths: &[f32], values: &[f32]| {
            SampledSpectrum::new(wavelengths.to_vec(), values.to_vec()).expect_err("invalid")
        };
        assert_eq!(error(&[400.0], &[1.0]), SampleError::TooFew);
        assert_eq!(error(&[], &[]), SampleError::TooFew);
        assert_eq!(error(&[400.0, 500.0], &[1.0]), SampleError::LengthsDiffer);
        assert_eq!(error(&[400.0, 400.0], &[1.0, 2.0]), SampleError::NotIncreasing);
        assert_eq!(error(&[500.0, 400.0], &[1.0, 2.0]), SampleError::NotIncreasing);
        assert_eq!(error(&[400.0, 500.0], &[1.0, f32::NAN]), SampleError::NotFinite);
        assert_eq!(error(&[400.0, f32::INFINITY], &[1.0, 1.0]), SampleError::NotFinite);
    }
}
