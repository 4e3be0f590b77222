//! Exposure and tone mapping: from unbounded linear values to those of a display.

use crate::numeric::{Matrix, multiply};

/// A mapping of unbounded linear values to [0, 1].
///
/// The result is still linear, relative to the display's white; sRGB encoding comes after.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ToneMap {
    /// No mapping: values above 1 are clipped when they are encoded.
    #[default]
    None,
    /// The Academy Color Encoding System's reference rendering transform and sRGB output
    /// transform, as fitted by Stephen Hill (2016).
    Aces,
    /// AgX by Troy Sobotka (2022), base look, with Benjamin Wrensch's polynomial for its curve
    /// (2023). Bright colours fade to white without shifting in hue.
    Agx,
    /// John Hable's filmic curve of "Uncharted 2" (2010), with white at 11.2 and an exposure of 2.
    Filmic,
}

/// The factor for an exposure in stops: 2^stops.
pub fn exposure_scale(stops: f32) -> f32 {
    stops.exp2()
}

impl ToneMap {
    /// Maps a linear colour (BT.709 primaries).
    pub fn apply(self, color: [f32; 3]) -> [f32; 3] {
        match self {
            Self::None => color,
            Self::Aces => aces(color),
            Self::Agx => agx(color),
            Self::Filmic => color.map(filmic),
        }
    }
}

/// From BT.709 to the space of the rendering transform, desaturated.
const ACES_INPUT: Matrix = [
    [0.597_19, 0.354_58, 0.048_23],
    [0.076_00, 0.908_34, 0.015_66],
    [0.028_40, 0.133_83, 0.837_77],
];

/// From the space of the output transform to BT.709.
const ACES_OUTPUT: Matrix = [
    [1.604_75, -0.531_08, -0.073_67],
    [-0.102_08, 1.108_13, -0.006_05],
    [-0.003_27, -0.072_76, 1.076_02],
];

/// Hill's fit: a matrix, a ratio of quadratics per channel, a matrix.
fn aces(color: [f32; 3]) -> [f32; 3] {
    let fitted = multiply(&ACES_INPUT, color.map(|value| value.max(0.0))).map(|value| {
        // Both quadratics overflow above 1e19, where the ratio has long converged.
        let value = value.min(1e6);
        (value * (value + 0.024_578_6) - 0.000_090_537)
            / (value * (0.983_729 * value + 0.432_951) + 0.238_081)
    });
    multiply(&ACES_OUTPUT, fitted).map(|value| value.clamp(0.0, 1.0))
}

/// Mixes the primaries, so that bright colours lose saturation.
const AGX_INSET: Matrix = [
    [0.842_479_1, 0.078_433_6, 0.079_223_7],
    [0.042_328_2, 0.878_468_6, 0.079_166_1],
    [0.042_375_7, 0.078_433_6, 0.879_143],
];

/// The inverse of [`AGX_INSET`].
const AGX_OUTSET: Matrix = [
    [1.196_879, -0.098_020_9, -0.099_029_7],
    [-0.052_896_9, 1.151_903_1, -0.098_961_2],
    [-0.052_971_6, -0.098_043_5, 1.151_073_7],
];

/// AgX covers −10 to +6.5 stops around middle grey (0.18); these bounds are in stops around 1.
const AGX_STOPS: [f32; 2] = [-12.473_93, 4.026_069];

/// AgX: inset, logarithm, sigmoid curve, outset, and the inverse of a display power of 2.2.
fn agx(color: [f32; 3]) -> [f32; 3] {
    let [min, max] = AGX_STOPS;
    let curved = multiply(&AGX_INSET, color.map(|value| value.max(0.0))).map(|value| {
        let stops = value.max(f32::MIN_POSITIVE).log2().clamp(min, max);
        agx_curve((stops - min) / (max - min))
    });
    multiply(&AGX_OUTSET, curved).map(|value| value.clamp(0.0, 1.0).powf(2.2))
}

/// Wrensch's polynomial of degree six for AgX's default contrast, from [0, 1] to [0, 1].
fn agx_curve(x: f32) -> f32 {
    const COEFFICIENTS: [f32; 7] = [-0.002_32, 0.119_1, 0.429_8, -6.868, 31.96, -40.14, 15.5];
    COEFFICIENTS.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// Hable's curve per channel, scaled so that 11.2 maps to white.
fn filmic(value: f32) -> f32 {
    const WHITE: f32 = 11.2;
    const EXPOSURE: f32 = 2.0;
    (hable(value.max(0.0) * EXPOSURE) / hable(WHITE)).min(1.0)
}

/// Shoulder, linear section and toe in one ratio (Hable 2010), with his letters.
fn hable(x: f32) -> f32 {
    let (a, b, c, d, e, f) = (0.15, 0.50, 0.10, 0.20, 0.02, 0.30);
    // Converges long before the quadratics overflow.
    let x = x.min(1e6);
    (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [ToneMap; 3] = [ToneMap::Aces, ToneMap::Agx, ToneMap::Filmic];

    #[test]
    fn curves_increase_from_black_to_white() {
        for tone_map in ALL {
            let mut previous = -1.0;
            for step in 0..400 {
                let value = (step as f32 * 0.1 - 30.0).exp2();
                let [red, green, blue] = tone_map.apply([value; 3]);
                assert!((0.0..=1.0).contains(&red), "{tone_map:?} {value} {red}");
                // The published matrices preserve grey within their precision.
                assert!((red - green).abs() < 2e-3 && (red - blue).abs() < 2e-3, "{tone_map:?}");
                assert!(red >= previous - 1e-4, "{tone_map:?} decreases at {value}");
                previous = red;
            }
            assert!(tone_map.apply([0.0; 3])[0] < 0.002, "{tone_map:?}");
            assert!(previous > 0.95, "{tone_map:?} ends at {previous}");
        }
    }

    #[test]
    fn extreme_values_stay_in_range() {
        for tone_map in ALL {
            for value in [f32::INFINITY, f32::MAX, f32::NEG_INFINITY, f32::NAN, -1.0] {
                let mapped = tone_map.apply([value, 0.0, 1.0]);
                assert!(mapped.iter().all(|v| (0.0..=1.0).contains(v)), "{tone_map:?} {value}");
            }
        }
    }

    #[test]
    fn agx_outset_is_the_inverse_of_the_inset() {
        for axis in 0..3 {
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            let back = multiply(&AGX_OUTSET, multiply(&AGX_INSET, unit));
            for (a, b) in back.iter().zip(&unit) {
                assert!((a - b).abs() < 2e-6, "{back:?}");
            }
        }
    }

    #[test]
    fn exposure_is_in_stops() {
        assert_eq!(exposure_scale(3.0), 8.0);
        assert_eq!(exposure_scale(-1.0), 0.5);
    }
}
