//! The criterion of Mitsuba's render tests: a z-test per pixel and channel, Šidák's correction, and
//! a share of exceptions.
//!
//! A pixel's channel passes if the reference's mean and variance of a single sample do not make
//! what was rendered too unlikely. All of it happens in CIE XYZ, of which the reference files hold
//! the linear map to RGB: of the mean, and of the three variances.

use etendue_testkit::special::normal_tail;

use crate::portable_float_map::Picture;

/// The probability of one false alarm in a whole picture.
const SIGNIFICANCE: f64 = 0.01;
/// Variances are at least this: where the reference saw none, rounding is not to count.
const LEAST_VARIANCE: f64 = 1e-4;

/// Linear Rec. 709 to XYZ (ITU-R BT.709, D65).
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_453, 0.357_580, 0.180_423],
    [0.212_671, 0.715_160, 0.072_169],
    [0.019_334, 0.119_193, 0.950_227],
];

/// A rendered picture, and what it should be.
pub(crate) struct Comparison<'a> {
    pub(crate) picture: &'a Picture,
    /// Samples per pixel of `picture`.
    pub(crate) sample_count: f64,
    pub(crate) reference: &'a Picture,
    /// The variance of a single sample.
    pub(crate) variance: &'a Picture,
}

/// What the test found.
pub(crate) struct Outcome {
    /// The share of pixels' channels that pass, from 0 to 1.
    pub(crate) accepted: f64,
    /// The p-value of every pixel for X, Y and Z.
    pub(crate) p_values: Picture,
}

impl Comparison<'_> {
    /// Runs the test.
    ///
    /// # Errors
    /// If the sizes differ.
    pub(crate) fn test(&self) -> Result<Outcome, String> {
        let size = self.picture.size;
        if [self.reference.size, self.variance.size] != [size; 2] {
            let (expected, variance) = (self.reference.size, self.variance.size);
            return Err(format!("the sizes differ: {size:?}, {expected:?}, {variance:?}"));
        }
        let pixels = self.picture.pixels.iter().zip(&self.reference.pixels);
        let p_values = pixels.zip(&self.variance.pixels).map(|((mean, expected), variance)| {
            let [mean, expected, variance] = [mean, expected, variance].map(to_xyz);
            let p = |channel| self.p_value(mean[channel], expected[channel], variance[channel]);
            std::array::from_fn(|channel| p(channel) as f32)
        });
        let p_values = Picture { size, pixels: p_values.collect() };
        // Šidák: with this level for each of n tests, the chance of any false alarm is as wanted.
        let pixel_count = p_values.pixels.len() as f64;
        let level = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / pixel_count);
        let values = p_values.pixels.as_flattened().iter();
        let count = values.filter(|p| f64::from(**p) > level).count();
        Ok(Outcome { accepted: count as f64 / (3.0 * pixel_count), p_values })
    }

    /// The probability of a mean at least as far out; zero of what is not a number.
    fn p_value(&self, mean: f64, expected: f64, variance: f64) -> f64 {
        let error = (variance.max(LEAST_VARIANCE) / self.sample_count).sqrt();
        let z = (mean - expected).abs() / error;
        if z.is_finite() { 2.0 * normal_tail(z) } else { 0.0 }
    }
}

fn to_xyz(rgb: &[f32; 3]) -> [f64; 3] {
    let [red, green, blue] = rgb.map(f64::from);
    XYZ_FROM_RGB.map(|row| row[0] * red + row[1] * green + row[2] * blue)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constant(value: f32) -> Picture {
        Picture { size: [10, 10], pixels: vec![[value; 3]; 100] }
    }

    /// The share that passes of a picture that is off by this many standard errors.
    fn accepted(errors: f32) -> f64 {
        // Grey of 1 has Y = 1, so Y's variance is 0.25, and its standard error with 25 samples 0.1.
        let (picture, reference, variance) =
            (constant(2.0 + 0.1 * errors), constant(2.0), constant(0.25));
        let comparison = Comparison {
            picture: &picture,
            sample_count: 25.0,
            reference: &reference,
            variance: &variance,
        };
        comparison.test().unwrap().accepted
    }

    /// Of 100 pixels, each is tested at a level of 1.005e-4, which is 3.8893 standard deviations.
    /// A grey difference d is 0.950 d in X and 1.089 d in Z, with standard errors of 0.0975 and
    /// 0.1043: 0.9749 and 1.0435 times as many as in Y.
    #[test]
    fn thresholds_are_those_of_sidak() {
        assert_eq!(accepted(3.70), 1.0);
        assert!((accepted(3.75) - 2.0 / 3.0).abs() < 1e-9);
        assert!((accepted(3.92) - 1.0 / 3.0).abs() < 1e-9);
        assert_eq!(accepted(4.05), 0.0);
    }

    #[test]
    fn what_is_not_a_number_fails() {
        assert_eq!(accepted(f32::NAN), 0.0);
        assert_eq!(accepted(f32::INFINITY), 0.0);
    }
}
