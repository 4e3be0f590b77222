//! Transcendental functions in the primitives of [`Real`], so that lanes and single numbers agree.

use super::float::Real;
use std::f32::consts::{LOG2_E, SQRT_2, TAU};

/// ln 2 in two parts: the first has so few digits that its products with exponents are exact.
const LN_2_HIGH: f32 = 0.693_359_4;
const LN_2_LOW: f32 = -2.121_944_4e-4;

/// Beyond these e^x is taken as zero and as infinite; between them its exponent is a normal one.
const EXP_RANGE: [f32; 2] = [-87.0, 88.0];

/// The polynomial with the given coefficients, the constant first: at least two.
///
/// Even and odd powers are summed up by Horner's scheme apart from each other, as its chain of
/// operations is half as long then.
#[inline(always)]
pub(super) fn polynomial<R: Real, const COUNT: usize>(x: R, coefficients: &[f32; COUNT]) -> R {
    let square = x * x;
    let (mut odd, mut even) = (x.like(coefficients[COUNT - 1]), x.like(coefficients[COUNT - 2]));
    // Not by an iterator's fold: that is not always inlined, and would lose the instructions.
    for &coefficient in coefficients[..COUNT - 2].iter().rev() {
        // The one that was `even` is now the sum of the odd powers that follow.
        (odd, even) = (even, odd * square + coefficient);
    }
    odd * x + even
}

/// e^x as 2ⁿ · e^r with |r| ≤ ln 2 / 2. The coefficients interpolate (e^r − 1 − r) / r² at
/// Chebyshev's nodes: within 1.1e-8.
#[inline(always)]
pub(super) fn exp<R: Real>(x: R) -> R {
    const COEFFICIENTS: [f32; 5] = [0.5, 0.166_665_76, 0.041_666_552, 0.008_363_233, 0.001_392_625];
    let [lowest, highest] = EXP_RANGE;
    // In this order NaN stays.
    let limited = x.like(highest).min(x.like(lowest).max(x));
    let exponent = (limited * LOG2_E).nearest();
    let r = limited - exponent * LN_2_HIGH - exponent * LN_2_LOW;
    let power = (r * r * polynomial(r, &COEFFICIENTS) + r + 1.0) * exponent.power_of_two();
    let power = R::select(x.below(lowest), x.zero(), power);
    R::select(x.above(highest), x.like(f32::INFINITY), power)
}

/// ln x as n ln 2 + ln (1 + f) with 1 + f from √½ to √2, and ln (1 + f) = 2 artanh s with
/// s = f / (2 + f), arranged as in Sun's `fdlibm`: f, which is exact, less a small correction. The
/// coefficients interpolate (2 artanh s / s − 2) / s² at Chebyshev's nodes: within 2e-7 of the
/// first, which is 1e-9 of the logarithm.
#[inline(always)]
pub(super) fn ln<R: Real>(x: R) -> R {
    const COEFFICIENTS: [f32; 3] = [0.666_666_87, 0.399_887_6, 0.295_809_86];
    let (mantissa, exponent) = x.mantissa_and_exponent();
    let halved = mantissa.above(SQRT_2);
    let f = R::select(halved, mantissa * 0.5, mantissa) - 1.0;
    let exponent = R::select(halved, exponent + 1.0, exponent);
    let s = f / (f + 2.0);
    let z = s * s;
    let rest = z * polynomial(z, &COEFFICIENTS);
    let correction = s * (f - rest) - exponent * LN_2_LOW;
    exponent * LN_2_HIGH + (f - correction)
}

/// Sine and cosine of an angle between −π/4 and π/4: their Taylor series, whose next terms are below
/// 3·10⁻⁹ there.
#[inline(always)]
pub(super) fn sin_cos_eighth<R: Real>(angle: R) -> (R, R) {
    const SINE: [f32; 4] = [-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0];
    const COSINE: [f32; 5] = [-0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0];
    let square = angle * angle;
    let sine = angle + angle * (square * polynomial(square, &SINE));
    (sine, square * polynomial(square, &COSINE) + 1.0)
}

/// Sine and cosine of 2πx. The nearest turn and the nearest quarter are taken off exactly.
#[inline(always)]
pub(super) fn sin_cos_turn<R: Real>(x: R) -> (R, R) {
    let rest = x - x.nearest();
    // From −2 to 2: odd ones swap, and halves negate.
    let quarters = (rest * 4.0).nearest();
    let (sine, cosine) = sin_cos_eighth((rest - quarters * 0.25) * TAU);
    let square = quarters * quarters;
    let (is_odd, is_half) = (square.equals(square.like(1.0)), square.above(2.0));
    let y = R::select(is_odd, cosine * quarters, sine);
    let x = R::select(is_odd, -sine * quarters, cosine);
    (R::select(is_half, -y, y), R::select(is_half, -x, x))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The greatest error in units of the last place over `count` steps from `low` to `high`.
    fn worst(
        [low, high]: [f32; 2],
        function: impl Fn(f32) -> f32,
        exact: impl Fn(f64) -> f64,
    ) -> f64 {
        const COUNT: u32 = 200_000;
        let error = |step: u32| {
            let x = low + (high - low) * (step as f32 / COUNT as f32);
            let expected = exact(f64::from(x));
            let nearest = expected.abs().max(f64::from(f32::MIN_POSITIVE)) as f32;
            let unit = f64::from(nearest.next_up()) - f64::from(nearest);
            (f64::from(function(x)) - expected).abs() / unit
        };
        (0..=COUNT).map(error).fold(0.0, f64::max)
    }

    #[test]
    fn exponentials_are_good_to_two_units() {
        for range in [[-1.0, 1.0], [-20.0, 20.0], EXP_RANGE] {
            let off = worst(range, exp, f64::exp);
            assert!(off < 2.0, "{range:?}: {off}");
        }
        assert_eq!((exp(0.0_f32), exp(-88.0_f32)), (1.0, 0.0));
        assert_eq!((exp(f32::NEG_INFINITY), exp(f32::INFINITY)), (0.0, f32::INFINITY));
        assert!(exp(f32::NAN).is_nan());
    }

    #[test]
    fn logarithms_are_good_to_two_units() {
        for range in [[f32::MIN_POSITIVE, 1e-30], [1e-6, 0.1], [0.1, 3.0], [0.999, 1.001]] {
            let off = worst(range, ln, f64::ln);
            assert!(off < 2.0, "{range:?}: {off}");
        }
        assert!(worst([1.0, f32::MAX], ln, f64::ln) < 2.0);
        assert_eq!(ln(1.0_f32), 0.0);
    }

    #[test]
    fn sine_and_cosine_are_good_to_two_roundings() {
        for step in -4000_i16..=4000 {
            let turns = f32::from(step) / 1999.0;
            let (sine, cosine) = sin_cos_turn(turns);
            let (true_sine, true_cosine) = (f64::from(turns) * std::f64::consts::TAU).sin_cos();
            assert!((f64::from(sine) - true_sine).abs() <= 1.2e-7, "{turns}");
            assert!((f64::from(cosine) - true_cosine).abs() <= 1.2e-7, "{turns}");
        }
        assert_eq!(sin_cos_turn(0.25_f32), (1.0, 0.0));
        assert_eq!(sin_cos_turn(-0.5_f32).1, -1.0);
    }
}
