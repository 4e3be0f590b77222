//! [`SampledSpectrum`]: a function of wavelength, known at some wavelengths and linear between.

use std::fmt;

/// A spectrum given by its values at increasing wavelengths; linear between them, zero outside.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledSpectrum {
    wavelengths_nm: Vec<f32>,
    values: Vec<f32>,
}

/// What is wrong with a sample of a [`SampledSpectrum`].
#[derive(Clone, Debug, PartialEq)]
pub enum SampleError {
    /// A wavelength or a value is infinite or NaN.
    NotFinite,
    /// A wavelength is not larger than the one before.
    NotIncreasing,
    /// There are fewer than two samples.
    TooFew,
    /// There are not as many values as wavelengths.
    LengthsDiffer,
    /// A sample has no value, or no wavelength.
    Incomplete,
    /// This text, shortened to a few characters, stands where a number is expected.
    NotANumber(String),
}

impl SampledSpectrum {
    /// A spectrum from samples, in order of wavelength (nanometres).
    ///
    /// # Errors
    ///
    /// If there are fewer than two samples or not as many values as wavelengths, if a number is
    /// not finite, or if the wavelengths do not increase.
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

    /// The values of the samples, one for each wavelength; finite.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The value at a wavelength in nanometres: linear between samples, zero beyond the first and
    /// the last, and at NaN.
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

    /// A spectrum to [`push`](Self::push) samples to.
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

    /// The spectrum, once all samples are in.
    pub(crate) fn finish(self) -> Result<Self, SampleError> {
        if self.values.len() < 2 { Err(SampleError::TooFew) } else { Ok(self) }
    }
}

impl fmt::Display for SampleError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite => write!(formatter, "a number is not finite"),
            Self::NotIncreasing => write!(formatter, "the wavelengths do not increase"),
            Self::TooFew => write!(formatter, "a spectrum has at least two samples"),
            Self::LengthsDiffer => write!(formatter, "not as many values as wavelengths"),
            Self::Incomplete => {
                write!(formatter, "a sample is a wavelength in nanometres and a value")
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
    fn samples_are_joined_by_lines() {
        assert_eq!(ramp().interpolate(400.0), 1.0);
        assert_eq!(ramp().interpolate(450.0), 2.0);
        assert_eq!(ramp().interpolate(500.0), 3.0);
        assert_eq!(ramp().interpolate(600.0), 1.0);
        assert_eq!(ramp().interpolate(700.0), -1.0);
    }

    #[test]
    fn outside_the_samples_is_zero() {
        for wavelength in [399.999, 700.001, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(ramp().interpolate(wavelength), 0.0);
        }
    }

    #[test]
    fn bad_samples_are_refused() {
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
