//! A colour map for error maps: from black through violet, red and orange to pale yellow.

use crate::numeric::clamp_number;

/// Lightness of the first and the last colour.
const LIGHTNESS: [f32; 2] = [0.08, 0.97];
/// Hue of the first and the last colour in degrees: from violet through red to yellow.
const HUE: [f32; 2] = [285.0, 465.0];
/// The maximum chroma.
const MAX_CHROMA: f32 = 0.19;

/// The colour of a value from 0 to 1, as linear RGB in [0, 1]. Values outside are clamped; NaN
/// becomes zero.
///
/// Lightness and hue change linearly in Oklab (Ottosson, "A perceptual color space for image
/// processing", 2020), so that equal steps look equal, even without colour.
pub(crate) fn heat(value: f32) -> [f32; 3] {
    let t = clamp_number(value, 0.0, 1.0);
    let mix = |range: [f32; 2]| range[0] + (range[1] - range[0]) * t;
    let chroma = MAX_CHROMA * (std::f32::consts::PI * (0.12 + 0.76 * t)).sin();
    let (sine, cosine) = mix(HUE).to_radians().sin_cos();
    linear_of_oklab([mix(LIGHTNESS), chroma * cosine, chroma * sine])
        .map(|value| value.clamp(0.0, 1.0))
}

/// Converts Oklab to linear BT.709, with the matrices of Ottosson's article.
fn linear_of_oklab([lightness, a, b]: [f32; 3]) -> [f32; 3] {
    let long = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let medium = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let short = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        4.076_741_7 * long - 3.307_711_6 * medium + 0.230_969_94 * short,
        -1.268_438 * long + 2.609_757_4 * medium - 0.341_319_38 * short,
        -0.004_196_086_3 * long - 0.703_418_6 * medium + 1.707_614_7 * short,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oklab_black_and_white() {
        for (lightness, expected) in [(0.0, 0.0), (1.0, 1.0)] {
            for value in linear_of_oklab([lightness, 0.0, 0.0]) {
                assert!((value - expected).abs() < 1e-5, "{value}");
            }
        }
    }

    #[test]
    fn luminance_increases_with_every_step() {
        let luminance = |[r, g, b]: [f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        for step in 0..255 {
            let (low, high) = (heat(step as f32 / 255.0), heat((step + 1) as f32 / 255.0));
            assert!(luminance(high) > luminance(low), "{step}");
        }
    }

    #[test]
    fn values_outside_are_clamped() {
        assert_eq!(heat(-1.0), heat(0.0));
        assert_eq!(heat(f32::NAN), heat(0.0));
        assert_eq!(heat(7.0), heat(1.0));
    }
}
