//! LDR-FLIP: the perceived difference of two images that alternate on a display.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference
//! Evaluator for Alternating Images", Proceedings of the ACM on Computer Graphics and Interactive
//! Techniques 3(2), 2020. Section numbers below are the paper's. YCxCz is a linear opponent space
//! (luminance, red-green, blue-yellow) scaled like CIELAB.

use rayon::prelude::*;

use super::error_map::{ErrorMap, is_finite};
use crate::numeric::{Matrix, clamp_number, multiply};
use crate::{ColorImage, ImageError};

/// Pixels per degree of visual angle for a 0.7 m wide display of 3840 pixels at a distance of 0.7 m
/// (section 3): 0.7 · 3840 / 0.7 · π / 180.
pub const DEFAULT_PIXELS_PER_DEGREE: f32 = 67.020_64;

/// The exponent of the colour difference, q_c (section 4.1.3).
const COLOR_EXPONENT: f32 = 0.7;
/// The exponent of the feature difference, q_f (section 4.2.2).
const FEATURE_EXPONENT: f32 = 0.5;
/// The fraction p_c of the maximum colour difference that maps to [`KNEE_OUTPUT`] (section 4.1.3).
const KNEE_INPUT: f32 = 0.4;
/// The error p_t that the knee maps to (section 4.1.3).
const KNEE_OUTPUT: f32 = 0.95;
/// The width of the most visible edges and points in degrees (section 4.2.1).
const FEATURE_WIDTH: f32 = 0.082;

/// Linear BT.709 to CIE XYZ, as ratios whose rows add up to the white point below.
const XYZ_OF_RGB: Matrix = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// The inverse of [`XYZ_OF_RGB`].
const RGB_OF_XYZ: Matrix = [
    [3.241_003_2, -1.537_399, -0.498_615_9],
    [-0.969_224_3, 1.875_93, 0.041_554_2],
    [0.055_639_4, -0.204_011_2, 1.057_149],
];

/// XYZ of white (D65).
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

/// The error per pixel, from 0 (no visible difference) to 1, and its mean.
///
/// Colours are linear and clamped to [0, 1], as by a display; apply exposure and tone mapping first.
/// [`DEFAULT_PIXELS_PER_DEGREE`] is the display of the paper.
///
/// # Errors
/// [`ImageError`] if the sizes differ, there are no pixels, or `pixels_per_degree` is not between
/// 1 and 1000.
pub fn flip(
    image: &ColorImage,
    reference: &ColorImage,
    pixels_per_degree: f32,
) -> Result<ErrorMap, ImageError> {
    image.check_comparable(reference)?;
    if !(1.0..=1000.0).contains(&pixels_per_degree) {
        let message = format!("{pixels_per_degree} pixels per degree is not between 1 and 1000");
        return Err(ImageError::invalid_picture(message));
    }
    let [(a_color, a_features), (b_color, b_features)] = [image, reference].map(|image| {
        let opponent = opponent_planes(image);
        let features = features(&opponent[0], pixels_per_degree);
        (perceived_colors(opponent, pixels_per_degree), features)
    });
    let largest = max_color_difference();
    let values = (0..image.pixels.len()).into_par_iter().map(|index| {
        if !is_finite(&image.pixels[index]) || !is_finite(&reference.pixels[index]) {
            return f32::NAN;
        }
        let color =
            redistribute(hyab(a_color[index], b_color[index]).powf(COLOR_EXPONENT), largest);
        let [edge, point] =
            [0, 1].map(|kind| (a_features[index][kind] - b_features[index][kind]).abs());
        let feature = (edge.max(point) / std::f32::consts::SQRT_2).powf(FEATURE_EXPONENT);
        color.powf(1.0 - feature.clamp(0.0, 1.0))
    });
    Ok(ErrorMap::new(image, values.collect()))
}

/// One channel of an image.
struct Plane {
    width: usize,
    values: Vec<f32>,
}

/// The clamped image in YCxCz, one plane per channel. NaN becomes black.
fn opponent_planes(image: &ColorImage) -> [Plane; 3] {
    let convert =
        |pixel: &[f32; 3]| opponent_of_rgb(pixel.map(|value| clamp_number(value, 0.0, 1.0)));
    let pixels: Vec<[f32; 3]> = image.pixels.par_iter().map(convert).collect();
    [0, 1, 2].map(|channel| Plane {
        width: image.width as usize,
        values: pixels.iter().map(|pixel| pixel[channel]).collect(),
    })
}

/// A Gaussian of the contrast sensitivity functions (section 4.1.1, table 1).
struct Sensitivity {
    amplitude: f32,
    scale: f32,
}

/// Luminance, red-green and blue-yellow. The second Gaussian of the first two has amplitude zero.
const SENSITIVITIES: [&[Sensitivity]; 3] = [
    &[Sensitivity { amplitude: 1.0, scale: 0.0047 }],
    &[Sensitivity { amplitude: 1.0, scale: 0.0053 }],
    &[Sensitivity { amplitude: 34.1, scale: 0.04 }, Sensitivity { amplitude: 13.5, scale: 0.025 }],
];

/// Filters the channels like the eye, and converts to CIELAB with the Hunt effect (section 4.1).
fn perceived_colors(opponent: [Plane; 3], pixels_per_degree: f32) -> Vec<[f32; 3]> {
    let blurred: Vec<Plane> = opponent
        .iter()
        .zip(SENSITIVITIES)
        .map(|(plane, gaussians)| blur(plane, gaussians, pixels_per_degree))
        .collect();
    (0..blurred[0].values.len())
        .into_par_iter()
        .map(|index| {
            let color = [0, 1, 2].map(|channel: usize| blurred[channel].values[index]);
            hunt_adjusted_lab(rgb_of_opponent(color).map(|value| value.clamp(0.0, 1.0)))
        })
        .collect()
}

/// Convolves with the normalised sum of Gaussians. Each is separable, but their sum is not.
fn blur(plane: &Plane, gaussians: &[Sensitivity], pixels_per_degree: f32) -> Plane {
    use std::f32::consts::PI;
    // Three standard deviations of the widest Gaussian of all channels.
    let widest = SENSITIVITIES.iter().flat_map(|list| list.iter());
    let widest = widest.map(|gaussian| gaussian.scale).fold(0.0, f32::max);
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    let kernels: Vec<(f32, Vec<f32>)> = gaussians
        .iter()
        .map(|gaussian| {
            let weight = |x: i32| {
                let degrees = x as f32 / pixels_per_degree;
                (-PI * PI * degrees * degrees / gaussian.scale).exp()
            };
            let kernel: Vec<f32> = (-radius..=radius).map(weight).collect();
            (gaussian.amplitude * (PI / gaussian.scale).sqrt(), kernel)
        })
        .collect();
    let total: f32 =
        kernels.iter().map(|(weight, kernel)| weight * kernel.iter().sum::<f32>().powi(2)).sum();
    let mut sum = vec![0.0; plane.values.len()];
    for (weight, kernel) in &kernels {
        let filtered = convolve(plane, kernel, kernel);
        for (target, value) in sum.iter_mut().zip(&filtered.values) {
            *target += weight / total * value;
        }
    }
    Plane { width: plane.width, values: sum }
}

/// The strength of edges and points at each pixel (section 4.2.1): the lengths of the vectors of
/// first and second derivatives of a Gaussian, over luminance scaled to [0, 1].
fn features(luminance: &Plane, pixels_per_degree: f32) -> Vec<[f32; 2]> {
    let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    let radius = (3.0 * deviation).ceil() as i32;
    let positions = || (-radius..=radius).map(|x| x as f32);
    let gaussian = |x: f32| (-x * x / (2.0 * deviation * deviation)).exp();
    let smooth: Vec<f32> = positions().map(gaussian).collect();
    let total: f32 = smooth.iter().sum();
    let smooth: Vec<f32> = smooth.iter().map(|value| value / total).collect();
    let edge = balance(positions().map(|x| -x * gaussian(x)).collect());
    let point = positions().map(|x| (x * x / (deviation * deviation) - 1.0) * gaussian(x));
    let point = balance(point.collect());

    let values = luminance.values.iter().map(|value| (value + 16.0) / 116.0).collect();
    let plane = Plane { width: luminance.width, values };
    let lengths = |derivative: &[f32]| {
        let x = convolve(&plane, derivative, &smooth);
        let y = convolve(&plane, &smooth, derivative);
        x.values.iter().zip(&y.values).map(|(x, y)| x.hypot(*y)).collect::<Vec<f32>>()
    };
    let (edges, points) = (lengths(&edge), lengths(&point));
    edges.into_iter().zip(points).map(|(edge, point)| [edge, point]).collect()
}

/// Scales positive weights to a sum of 1, and negative ones to a sum of −1.
fn balance(weights: Vec<f32>) -> Vec<f32> {
    let positive: f32 = weights.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f32 = -weights.iter().filter(|weight| **weight < 0.0).sum::<f32>();
    let scale = |weight| if weight > 0.0 { weight / positive } else { weight / negative };
    weights.into_iter().map(scale).collect()
}

/// Convolves rows with one kernel of odd length, then columns with another. The outermost pixels are
/// repeated beyond the border.
fn convolve(plane: &Plane, along_x: &[f32], along_y: &[f32]) -> Plane {
    let width = plane.width;
    let height = plane.values.len() / width;
    let mut rows = vec![0.0; plane.values.len()];
    rows.par_chunks_mut(width).zip(plane.values.par_chunks(width)).for_each(|(target, source)| {
        let radius = along_x.len() / 2;
        let first = std::iter::repeat_n(source[0], radius);
        let last = std::iter::repeat_n(source[width - 1], radius);
        let padded: Vec<f32> = first.chain(source.iter().copied()).chain(last).collect();
        for (offset, weight) in along_x.iter().enumerate() {
            for (value, source) in target.iter_mut().zip(&padded[offset..]) {
                *value += weight * source;
            }
        }
    });
    let mut values = vec![0.0; plane.values.len()];
    values.par_chunks_mut(width).enumerate().for_each(|(row, target)| {
        let radius = along_y.len() / 2;
        for (offset, weight) in along_y.iter().enumerate() {
            let source = (row + offset).saturating_sub(radius).min(height - 1) * width;
            for (value, source) in target.iter_mut().zip(&rows[source..source + width]) {
                *value += weight * source;
            }
        }
    });
    Plane { width, values }
}

/// Maps a colour difference to [0, 1]: steep up to the knee, flat beyond (section 4.1.3).
fn redistribute(difference: f32, largest: f32) -> f32 {
    let knee = KNEE_INPUT * largest;
    if difference < knee {
        KNEE_OUTPUT / knee * difference
    } else {
        KNEE_OUTPUT + (difference - knee) / (largest - knee) * (1.0 - KNEE_OUTPUT)
    }
}

/// The difference between pure green and pure blue, the maximum of a display.
fn max_color_difference() -> f32 {
    let green = hunt_adjusted_lab([0.0, 1.0, 0.0]);
    let blue = hunt_adjusted_lab([0.0, 0.0, 1.0]);
    hyab(green, blue).powf(COLOR_EXPONENT)
}

/// HyAB (Abasi, Tehran and Fairchild, "Distance metrics for very large color differences", 2020):
/// city-block distance in lightness, Euclidean in chroma.
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// CIELAB with chroma scaled by lightness: dark colours look less colourful (section 4.1.2).
fn hunt_adjusted_lab(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = relative_xyz(rgb).map(lab_curve);
    let lightness = 116.0 * y - 16.0;
    let chroma_scale = 0.01 * lightness;
    [lightness, 500.0 * (x - y) * chroma_scale, 200.0 * (y - z) * chroma_scale]
}

/// CIELAB's cube root with a linear part near zero.
fn lab_curve(t: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

fn opponent_of_rgb(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn rgb_of_opponent([luminance, red_green, blue_yellow]: [f32; 3]) -> [f32; 3] {
    let y = (luminance + 16.0) / 116.0;
    let relative = [y + red_green / 500.0, y, y - blue_yellow / 200.0];
    multiply(&RGB_OF_XYZ, std::array::from_fn(|axis| relative[axis] * WHITE[axis]))
}

/// XYZ relative to white.
fn relative_xyz(rgb: [f32; 3]) -> [f32; 3] {
    let xyz = multiply(&XYZ_OF_RGB, rgb);
    std::array::from_fn(|axis| xyz[axis] / WHITE[axis])
}
