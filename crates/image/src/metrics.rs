//! Error metrics: the difference of an image from its reference.
//!
//! All metrics take linear RGB. Those that average over pixels ([`mse`], [`relative_mse`],
//! [`mean_difference`], [`flip`]) also return a map with one value per pixel. Pixels where either
//! image is NaN or infinite are counted and excluded from the mean, and are NaN in the map.

mod blocks;
mod error_map;
mod flip;

pub use blocks::{BlockReport, BlockThresholds, Estimate, block_test};
pub use error_map::ErrorMap;
pub use flip::{DEFAULT_PIXELS_PER_DEGREE, flip};

use crate::{ColorImage, ImageError};
use error_map::is_finite;
/// Mean squared error: (x − r)², averaged over channels and pixels.
///
/// # Errors
/// [`ImageError`] if the sizes differ or there are no pixels.
pub fn mse(image: &ColorImage, reference: &ColorImage) -> Result<ErrorMap, ImageError> {
    per_pixel(image, reference, |value, reference| (value - reference).powi(2))
}

/// The offset that keeps [`relative_mse`] finite where the reference is black.
const RELATIVE_MSE_OFFSET: f32 = 0.01;

/// Relative mean squared error: (x − r)² / (r² + 0.01), averaged over channels and pixels
/// (Rousselle, Knaus and Zwicker, "Adaptive Sampling and Reconstruction using Greedy Error
/// Minimization", 2011, section 6).
///
/// # Errors
/// [`ImageError`] if the sizes differ or there are no pixels.
pub fn relative_mse(image: &ColorImage, reference: &ColorImage) -> Result<ErrorMap, ImageError> {
    per_pixel(image, reference, |value, reference| {
        (value - reference).powi(2) / (reference * reference + RELATIVE_MSE_OFFSET)
    })
}

/// The signed and absolute differences between an image and its reference.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanDifference {
    /// The mean of x − r per channel, over pixels that are finite in both images.
    pub signed: [f64; 3],
    /// [`signed`](Self::signed) divided by the mean of r per channel. Infinite or NaN if that is 0.
    pub relative: [f64; 3],
    /// |x − r| averaged over channels, per pixel and as a mean over pixels.
    pub absolute: ErrorMap,
}

/// The mean signed difference, which is near zero for unbiased noise, and the mean absolute
/// difference.
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

/// Averages an error function of (value, reference) over the channels of each pixel.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color_map::heat;

    fn image(pixels: &[[f32; 3]]) -> ColorImage {
        ColorImage { width: pixels.len() as u32, height: 1, pixels: pixels.to_vec() }
    }

    #[test]
    fn simple_cases_have_the_expected_values() {
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
    fn non_finite_pixels_are_counted_and_excluded() {
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
