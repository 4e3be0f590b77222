//! The sRGB transfer functions (IEC 61966-2-1), exact and with tables.

use std::sync::LazyLock;

use crate::numeric::clamp_number;

/// Encodes a linear value, where white is 1. The function continues beyond 1, and is odd.
pub fn linear_to_srgb(linear: f32) -> f32 {
    let magnitude = linear.abs();
    let encoded = if magnitude <= 0.003_130_8 {
        12.92 * magnitude
    } else {
        1.055 * magnitude.powf(1.0 / 2.4) - 0.055
    };
    encoded.copysign(linear)
}

/// Decodes an sRGB value, where white is 1: the inverse of [`linear_to_srgb`].
pub fn srgb_to_linear(encoded: f32) -> f32 {
    let magnitude = encoded.abs();
    let linear = if magnitude <= 0.040_45 {
        magnitude / 12.92
    } else {
        ((magnitude + 0.055) / 1.055).powf(2.4)
    };
    linear.copysign(encoded)
}

/// Decodes an 8-bit sRGB value, where white is 255, with a table.
pub fn srgb_u8_to_linear(encoded: u8) -> f32 {
    LINEAR_OF_U8[usize::from(encoded)]
}

/// The linear values of all 256 codes, for inner loops that would call [`srgb_u8_to_linear`].
pub fn linear_of_srgb_u8() -> &'static [f32; 256] {
    &LINEAR_OF_U8
}

/// Encodes a linear value to the nearest of 256 codes, where white is 255. Values outside [0, 1]
/// are clamped; NaN becomes zero.
///
/// The result equals the rounded exact function, but takes a few nanoseconds instead of a power. A
/// table over the exponent and the upper mantissa bits gives the first code of an interval. The
/// intervals are so short that each contains at most one threshold, which is then compared.
pub(crate) fn linear_to_srgb_u8(linear: f32) -> u8 {
    let encoder = &*U8_ENCODER;
    let clamped = clamp_number(linear, MIN_ENCODED, MAX_ENCODED);
    let interval = (clamped.to_bits() >> INTERVAL_SHIFT) - FIRST_INTERVAL;
    let code = encoder.first_codes[interval as usize];
    code + u8::from(clamped >= encoder.thresholds[usize::from(code)])
}

static LINEAR_OF_U8: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| decode_f64(code as f64 / 255.0) as f32));

static U8_ENCODER: LazyLock<U8Encoder> = LazyLock::new(U8Encoder::new);

/// An interval keeps the exponent and seven bits of the mantissa.
const INTERVAL_SHIFT: u32 = 23 - 7;
/// Intervals start at 2⁻¹³, below the threshold of code 1 (about 1.5e-4).
const FIRST_INTERVAL: u32 = (127 - 13) << 7;
/// Thirteen octaves of 128 intervals, up to 1.
const INTERVAL_COUNT: usize = 13 * 128;
/// The start of the first interval: 2⁻¹³.
const MIN_ENCODED: f32 = 1.0 / 8192.0;
/// The last float below 1.
const MAX_ENCODED: f32 = 1.0 - f32::EPSILON / 2.0;

/// The tables behind [`linear_to_srgb_u8`].
struct U8Encoder {
    /// `thresholds[code]` is the least linear value whose code is above `code`; infinite for the
    /// last code.
    thresholds: [f32; 256],
    /// The code of the first value in each interval.
    first_codes: [u8; INTERVAL_COUNT],
}

impl U8Encoder {
    fn new() -> Self {
        let thresholds: [f32; 256] = std::array::from_fn(|code| match code {
            255 => f32::INFINITY,
            _ => decode_f64((code as f64 + 0.5) / 255.0) as f32,
        });
        let first_codes = std::array::from_fn(|interval| {
            let start = interval_start(interval);
            // At most 255, because the last threshold is infinite.
            thresholds.partition_point(|&threshold| threshold <= start) as u8
        });
        Self { thresholds, first_codes }
    }
}

/// The first float of an interval.
fn interval_start(interval: usize) -> f32 {
    f32::from_bits((interval as u32 + FIRST_INTERVAL) << INTERVAL_SHIFT)
}

/// [`srgb_to_linear`] in double precision, for tables.
fn decode_f64(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        for (linear, encoded) in [(0.0, 0.0), (0.5, 0.735_357), (1.0, 1.0), (0.002, 0.025_84)] {
            assert!((linear_to_srgb(linear) - encoded).abs() < 1e-6, "{linear}");
            assert!((srgb_to_linear(encoded) - linear).abs() < 1e-6, "{encoded}");
        }
        assert_eq!(linear_to_srgb(-0.5), -linear_to_srgb(0.5));
    }

    #[test]
    fn all_codes_round_trip() {
        for code in 0..=255 {
            assert_eq!(linear_to_srgb_u8(srgb_u8_to_linear(code)), code);
        }
    }

    #[test]
    fn the_table_rounds_like_the_exact_function() {
        // Every 997th float in [0, 2): all exponents, all intervals. Only the neighbourhoods of
        // thresholds are skipped, where `powf` itself may round either way.
        for bits in (0..2.0f32.to_bits()).step_by(997) {
            let linear = f32::from_bits(bits);
            let exact = linear_to_srgb(linear.min(1.0)) * 255.0;
            if (exact.fract() - 0.5).abs() > 1e-4 {
                assert_eq!(linear_to_srgb_u8(linear), exact.round() as u8, "{linear}");
            }
        }
    }

    #[test]
    fn intervals_contain_at_most_one_threshold() {
        let codes = &U8_ENCODER.first_codes;
        assert!(codes.windows(2).all(|pair| pair[1] - pair[0] <= 1));
        assert_eq!((codes[0], codes[INTERVAL_COUNT - 1]), (0, 255));
        assert_eq!((interval_start(0), interval_start(INTERVAL_COUNT)), (MIN_ENCODED, 1.0));
    }

    #[test]
    fn values_outside_are_clamped() {
        assert_eq!(linear_to_srgb_u8(-1.0), 0);
        assert_eq!(linear_to_srgb_u8(f32::NEG_INFINITY), 0);
        assert_eq!(linear_to_srgb_u8(f32::NAN), 0);
        assert_eq!(linear_to_srgb_u8(f32::INFINITY), 255);
    }
}
