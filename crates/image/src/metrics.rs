//! How far an image is from its reference.
//!
//! All metrics take linear RGB. Those that average over pixels ([`mse`], [`relative_mse`],
//! [`mean_difference`], [`flip`]) return a map with one value per pixel beside the mean. Pixels
//! where either image is NaN or infinite say nothing about the rest: they are counted and left out
//! of the mean, and are NaN in the map.

mod blocks;
mod flip;

pub use blocks::{BlockReport, BlockThresholds, Estimate, block_test};
pub use flip::{DEFAULT_PIXELS_PER_DEGREE, flip};

use crate::color_map::heat;
use crate::{ColorImage, ImageError, Picture};

/// One value per pixel, and their mean.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorMap {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The error of each pixel, the top row first; NaN where it is not defined.
    pub values: Vec<f32>,
    /// The mean over all pixels where it is defined; NaN if there are none.
    pub mean: f64,
    /// How many pixels were left out because either image is NaN or infinite there.
    pub non_finite: usize,
}

impl ErrorMap {
    /// Sums up a map that holds NaN where the error is not defined.
    fn new(image: &ColorImage, values: Vec<f32>) -> Self {
        let defined = values.iter().filter(|value| !value.is_nan());
        let (sum, count) = defined
            .fold((0.0, 0_usize), |(sum, count), &value| (sum + f64::from(value), count + 1));
        Self {
            width: image.width,
            height: image.height,
            mean: sum / count as f64,
            non_finite: values.len() - count,
            values,
        }
    }

    /// The map as a colour picture, [`heat`] from zero to `maximum`; white where it is not defined.
    pub fn to_picture(&self, maximum: f32) -> Picture {
        let color = |&value: &f32| if value.is_nan() { [1.0; 3] } else { heat(value / maximum) };
        let pixels = self.values.iter().map(color).collect();
        Picture::from_color_image(&ColorImage { width: self.width, height: self.height, pixels })
    }

    /// The value below which the given share of all defined values lies: a robust maximum for
    /// [`to_picture`](Self::to_picture). Zero if none is defined.
    pub fn quantile(&self, share: f32) -> f32 {
        let mut defined: Vec<f32> = self.values.iter().copied().filter(|v| !v.is_nan()).collect();
        if defined.is_empty() {
            return 0.0;
        }
        let index = (share.clamp(0.0, 1.0) * (defined.len() - 1) as f32).round() as usize;
        let index = index.min(defined.len() - 1);
        *defined.select_nth_unstable_by(index, f32::total_cmp).1
    }
}

/// Mean squared error: (x − r)², averaged over channels and pixels.
///
/// # Errors
/// [`ImageError`] if the sizes differ or there are no pixels.
pub fn mse(image: &ColorImage, reference: &ColorImage) -> Result<ErrorMap, ImageError> {
    per_pixel(image, reference, |value, reference| (value - reference).powi(2))
}

/// The offset that keeps [`relative_mse`] finite where the reference is black.
pub const RELATIVE_MSE_OFFSET: f32 = 0.01;

/// Relative mean squared error: (x − r)² / (r² + 0.01), averaged over channels and pixels.
/// (Rousselle, Knaus and Zwicker, "Adaptive Sampling and Reconstruction using Greedy Error
/// Minimization", 2011, section 6.)
///
/// # Errors
/// [`ImageError`] if the sizes differ or there are no pixels.
pub fn relative_mse(image: &ColorImage, reference: &ColorImage) -> Result<ErrorMap, ImageError> {
    per_pixel(image, reference, |value, reference| {
        (value - reference).powi(2) / (reference * reference + RELATIVE_MSE_OFFSET)
    })
}

/// How much brighter an image is than its reference.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanDifference {
    /// The mean of x − r per channel, over pixels that are finite in both.
    pub signed: [f64; 3],
    /// [`signed`](Self::signed) over the mean of r, per channel. Infinite or NaN if that is zero.
    pub relative: [f64; 3],
    /// |x − r|, averaged over channels, with its mean over pixels.
    pub absolute: ErrorMap,
}

/// The mean signed difference, which noise leaves near zero and a bias does not, and the mean
/// absolute one.
///
/// # Errors
/// [`ImageError`] if the sizes differ or there are no pixels.
pub fn mean_difference(
    image: &ColorImage,
    reference: &ColorImage,
) -> Result<MeanDifference, ImageError> {
    let absolute = per_pixel(image, reference, |value, reference| (value - reference).abs())?;
    let count = (absolute.values.len() - absolute.non_finite) as f64;
    let (mut differences, mut references) = ([0.0; 3], [0.0; 3]);
    for (pixel, reference) in image.pixels.iter().zip(&reference.pixels) {
        if !is_finite(pixel) || !is_finite(reference) {
            continue;
        }
        for channel in 0..3 {
            let expected = f64::from(reference[channel]);
            differences[channel] += f64::from(pixel[channel]) - expected;
            references[channel] += expected;
        }
    }
    Ok(MeanDifference {
        signed: differences.map(|sum| sum / count),
        relative: std::array::from_fn(|channel| differences[channel] / references[channel]),
        absolute,
    })
}

/// Averages an error of (value, reference) over the channels of each pixel.
fn per_pixel(
    image: &ColorImage,
    reference: &ColorImage,
    error: impl Fn(f32, f32) -> f32,
) -> Result<ErrorMap, ImageError> {
    image.check_comparable(reference)?;
    let pairs = image.pixels.iter().zip(&reference.pixels);
    let values = pairs.map(|(pixel, reference)| {
        if !is_finite(pixel) || !is_finite(reference) {
            return f32::NAN;
        }
        (0..3).map(|channel| error(pixel[channel], reference[channel])).sum::<f32>() / 3.0
    });
    Ok(ErrorMap::new(image, values.collect()))
}

fn is_finite(pixel: &[f32; 3]) -> bool {
    pixel.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: &[[f32; 3]]) -> ColorImage {
        ColorImage { width: pixels.len() as u32, height: 1, pixels: pixels.to_vec() }
    }

    #[test]
    fn closed_forms() {
        let (a, r) = (image(&[[2.0, 1.0, 0.0], [0.5; 3]]), image(&[[1.0, 1.0, 0.0], [0.0; 3]]));
        let map = mse(&a, &r).unwrap();
        assert!((map.mean - (1.0 / 3.0 + 0.25) / 2.0).abs() < 1e-7);
        assert_eq!(map.values[1], 0.25);
        let relative = relative_mse(&a, &r).unwrap();
        assert!((relative.mean - (1.0 / 1.01 / 3.0 + 25.0) / 2.0).abs() < 1e-5);
        let difference = mean_difference(&a, &r).unwrap();
        assert_eq!(difference.signed, [0.75, 0.25, 0.25]);
        assert_eq!(difference.relative, [1.5, 0.5, f64::INFINITY]);
        assert!((difference.absolute.mean - (1.0 / 3.0 + 0.5) / 2.0).abs() < 1e-7);
    }

    #[test]
    fn pixels_without_a_value_are_counted_and_left_out() {
        let a = image(&[[f32::NAN, 0.0, 0.0], [2.0; 3], [1.0; 3]]);
        let r = image(&[[0.0; 3], [0.0; 3], [f32::INFINITY; 3]]);
        let map = mse(&a, &r).unwrap();
        assert_eq!((map.mean, map.non_finite), (4.0, 2));
        assert!(map.values[0].is_nan() && map.values[2].is_nan());
        assert_eq!(mean_difference(&a, &r).unwrap().signed, [2.0; 3]);
        let color = map.to_picture(4.0).to_color_image().unwrap();
        assert_eq!(color.pixels, vec![[1.0; 3], heat(1.0), [1.0; 3]]);
    }

    #[test]
    fn sizes_must_agree() {
        let (a, b) = (image(&[[0.0; 3]; 2]), image(&[[0.0; 3]; 3]));
        let expected = ImageError::SizeMismatch { image: (2, 1), reference: (3, 1) };
        assert_eq!(mse(&a, &b), Err(expected));
        assert!(mse(&image(&[]), &image(&[])).is_err());
    }

    #[test]
    fn quantiles() {
        let values: Vec<_> = (0..101).map(|value| [value as f32; 3]).collect();
        let map = mse(&image(&values), &image(&[[0.0; 3]; 101])).unwrap();
        assert_eq!(map.quantile(0.5), 2500.0);
        assert_eq!((map.quantile(0.0), map.quantile(1.0)), (0.0, 10_000.0));
    }
}
