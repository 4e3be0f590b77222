//! The criterion of Mitsuba's render tests: a z-test for each pixel and channel with Šidák's
//! correction, and a share of pixels that may fail.
//!
//! A channel of a pixel fails if the difference of the means is too unlikely given their variances.
//! The test uses CIE XYZ. As in Mitsuba's reference files, the RGB variances are converted to XYZ
//! with the colour matrix itself; the result is close to the upper bound over all correlations.

use etendue::image::ColorImage;
use etendue_testkit::special::normal_tail;

use crate::comparison::Measured;

/// The probability of a false alarm in a whole picture.
const SIGNIFICANCE: f64 = 0.01;

/// Linear Rec. 709 to XYZ (ITU-R BT.709, D65).
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_453, 0.357_580, 0.180_423],
    [0.212_671, 0.715_160, 0.072_169],
    [0.019_334, 0.119_193, 0.950_227],
];

/// The result of the test.
pub(crate) struct Outcome {
    /// The share of pixel channels that pass, from 0 to 1.
    pub(crate) accepted: f64,
    /// The p-values of each pixel for X, Y and Z.
    pub(crate) p_values: ColorImage,
}

/// Tests whether both pictures are estimates of the same one. `least_variance` is a lower bound for
/// variances, so that rounding does not count where all samples are equal.
///
/// # Errors
/// If the sizes differ.
pub(crate) fn test(
    picture: &Measured,
    reference: &Measured,
    least_variance: f64,
) -> Result<Outcome, String> {
    let size = |image: &ColorImage| (image.width, image.height);
    let sizes = [&picture.mean, &picture.variance, &reference.mean, &reference.variance].map(size);
    if sizes.iter().any(|other| *other != sizes[0]) {
        return Err(format!("the sizes differ: {sizes:?}"));
    }
    let values = picture.mean.pixels.iter().zip(&picture.variance.pixels);
    let expected = reference.mean.pixels.iter().zip(&reference.variance.pixels);
    let p_values = values.zip(expected).map(|((mean, variance), (expected, expected_variance))| {
        let [mean, expected] = [mean, expected].map(to_xyz);
        let [variance, expected_variance] = [variance, expected_variance].map(to_xyz);
        std::array::from_fn(|channel| {
            let variance = variance[channel] + expected_variance[channel];
            let error = variance.max(least_variance).sqrt();
            p_value((mean[channel] - expected[channel]).abs() / error) as f32
        })
    });
    let pixels: Vec<[f32; 3]> = p_values.collect();
    // Šidák's correction: n tests at this level have the wanted probability of a false alarm.
    let pixel_count = pixels.len() as f64;
    let level = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / pixel_count);
    let count = pixels.as_flattened().iter().filter(|p| f64::from(**p) > level).count();
    let (width, height) = sizes[0];
    Ok(Outcome {
        accepted: count as f64 / (3.0 * pixel_count),
        p_values: ColorImage { width, height, pixels },
    })
}

/// The probability of a deviation of at least `z` standard errors; zero for NaN and infinity.
fn p_value(z: f64) -> f64 {
    if z.is_finite() { 2.0 * normal_tail(z) } else { 0.0 }
}

fn to_xyz(rgb: &[f32; 3]) -> [f64; 3] {
    let [red, green, blue] = rgb.map(f64::from);
    XYZ_FROM_RGB.map(|row| row[0] * red + row[1] * green + row[2] * blue)
}

/// Checks that the thresholds match Šidák's correction, and that NaN and infinity fail.
///
/// With 100 pixels, the level of each test is 1.005e-4, which is 3.8893 standard deviations. A grey
/// difference d is 0.950 d in X, d in Y and 1.089 d in Z. The standard errors are 0.0975, 0.1 and
/// 0.1043, so the z-values in X and Z are 0.9749 and 1.0435 times that in Y.
pub(crate) fn check_thresholds() -> Result<(), String> {
    let constant = |value: f32| ColorImage { width: 10, height: 10, pixels: vec![[value; 3]; 100] };
    let reference = Measured { mean: constant(2.0), variance: constant(0.004) };
    let accepted = |mean: f32| {
        let picture = Measured { mean: constant(mean), variance: constant(0.006) };
        test(&picture, &reference, 4e-6).map(|outcome| outcome.accepted)
    };
    let cases = [
        (2.0 + 0.1 * 3.70, 1.0),
        (2.0 + 0.1 * 3.75, 2.0 / 3.0),
        (2.0 + 0.1 * 3.92, 1.0 / 3.0),
        (2.0 + 0.1 * 4.05, 0.0),
        (f32::NAN, 0.0),
        (f32::INFINITY, 0.0),
    ];
    for (mean, expected) in cases {
        let found = accepted(mean)?;
        if (found - expected).abs() > 1e-9 {
            return Err(format!(
                "for a mean of {mean}, the accepted share is {found}, not {expected}"
            ));
        }
    }
    Ok(())
}
