//! The trait of floats, and its one-lane case.
//!
//! Transcendental functions are built from the primitives of [`Real`], so that lanes and scalars
//! agree.

use super::mask::Mask;
use std::f32::consts::{LOG2_E, SQRT_2, TAU};
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A single-precision float, or one per lane.
pub trait Real:
    Copy
    + Debug
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f32, Output = Self>
    + Sub<f32, Output = Self>
    + Mul<f32, Output = Self>
    + Div<f32, Output = Self>
{
    /// The result of a comparison.
    type Mask: Mask;

    /// `value` in as many lanes as `self` has.
    fn like(self, value: f32) -> Self;
    /// √x, correctly rounded.
    fn sqrt(self) -> Self;
    /// |x|.
    fn abs(self) -> Self;
    /// |x| with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// The greatest integer at or below x, for |x| below 2³¹.
    fn floor(self) -> Self;
    /// The nearest integer, for |x| below 2²². Ties go to the even one.
    #[inline(always)]
    fn nearest(self) -> Self {
        // The sum has no fractional bits.
        self + NO_FRACTION - NO_FRACTION
    }

    /// 2ⁿ for an integer n from −126 to 127.
    fn power_of_two(self) -> Self;
    /// Splits a positive normal number m · 2ⁿ with m in [1, 2) into (m, n).
    fn mantissa_and_exponent(self) -> (Self, Self);
    /// The next number above; +∞ and NaN are returned unchanged.
    fn next_up(self) -> Self;
    /// The next number below; −∞ and NaN are returned unchanged.
    fn next_down(self) -> Self;
    /// The next number above if `direction` is positive, the next below if it is negative, and x
    /// otherwise.
    fn next_towards(self, direction: Self) -> Self;
    /// Whether x < y.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether x ≤ y.
    fn le(self, other: Self) -> Self::Mask;
    /// Whether x = y.
    fn equals(self, other: Self) -> Self::Mask;
    /// Whether x is neither infinite nor NaN.
    fn is_finite(self) -> Self::Mask;
    /// `yes` where the mask is true, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Whether x > y.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// Whether x ≥ y.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }

    /// Whether x is greater than a constant.
    #[inline(always)]
    fn above(self, bound: f32) -> Self::Mask {
        self.gt(self.like(bound))
    }

    /// Whether x is less than a constant.
    #[inline(always)]
    fn below(self, bound: f32) -> Self::Mask {
        self.lt(self.like(bound))
    }

    /// The lesser of the two, or `other` if either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }

    /// The greater of the two, or `other` if either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.gt(other), self, other)
    }

    /// Zero in as many lanes as `self` has.
    #[inline(always)]
    fn zero(self) -> Self {
        self.like(0.0)
    }

    /// 1 / x.
    #[inline(always)]
    fn reciprocal(self) -> Self {
        self.like(1.0) / self
    }

    /// √x, or zero where rounding has made x negative.
    #[inline(always)]
    fn safe_sqrt(self) -> Self {
        self.max(self.zero()).sqrt()
    }

    /// The polynomial with the given coefficients, at least two, the constant first.
    ///
    /// Even and odd powers are summed separately by Horner's scheme, which halves the length of the
    /// dependency chain.
    #[inline(always)]
    fn polynomial<const COUNT: usize>(self, coefficients: &[f32; COUNT]) -> Self {
        let square = self * self;
        let (mut odd, mut even) =
            (self.like(coefficients[COUNT - 1]), self.like(coefficients[COUNT - 2]));
        // Not a fold of an iterator, which is not always inlined.
        for &coefficient in coefficients[..COUNT - 2].iter().rev() {
            // The previous `even` becomes the sum of odd powers for the next coefficient.
            (odd, even) = (even, odd * square + coefficient);
        }
        odd * self + even
    }

    /// e^x within two ulps; zero below −87, infinity above 88.
    ///
    /// Computed as 2ⁿ · e^r with |r| ≤ ln 2 / 2. The coefficients interpolate (e^r − 1 − r) / r² at
    /// the Chebyshev nodes, with an error below 1.1e-8.
    #[inline(always)]
    fn exp(self) -> Self {
        const COEFFICIENTS: [f32; 5] =
            [0.5, 0.166_665_76, 0.041_666_552, 0.008_363_233, 0.001_392_625];
        let [lowest, highest] = EXP_RANGE;
        // This order of the operands propagates NaN.
        let clamped = self.like(highest).min(self.like(lowest).max(self));
        let exponent = (clamped * LOG2_E).nearest();
        let r = clamped - exponent * LN_2_HIGH - exponent * LN_2_LOW;
        let power = (r * r * r.polynomial(&COEFFICIENTS) + r + 1.0) * exponent.power_of_two();
        let power = Self::select(self.below(lowest), self.zero(), power);
        Self::select(self.above(highest), self.like(f32::INFINITY), power)
    }

    /// ln x within two ulps for a positive normal number. For other numbers, the result is
    /// unspecified, but finite or NaN.
    ///
    /// Computed as n ln 2 + ln (1 + f) with 1 + f from √½ to √2, and ln (1 + f) = 2 artanh s with
    /// s = f / (2 + f), arranged as in Sun's `fdlibm`: f, which is exact, minus a small correction.
    /// The coefficients interpolate (2 artanh s / s − 2) / s² at the Chebyshev nodes, with an error
    /// of 2e-7 relative to the first, which is 1e-9 of the logarithm.
    #[inline(always)]
    fn ln(self) -> Self {
        const COEFFICIENTS: [f32; 3] = [0.666_666_87, 0.399_887_6, 0.295_809_86];
        let (mantissa, exponent) = self.mantissa_and_exponent();
        let halved = mantissa.above(SQRT_2);
        let f = Self::select(halved, mantissa * 0.5, mantissa) - 1.0;
        let exponent = Self::select(halved, exponent + 1.0, exponent);
        let s = f / (f + 2.0);
        let z = s * s;
        let rest = z * z.polynomial(&COEFFICIENTS);
        let correction = s * (f - rest) - exponent * LN_2_LOW;
        exponent * LN_2_HIGH + (f - correction)
    }

    /// Sine and cosine of an angle from −π/4 to π/4, within two roundings of 1.
    ///
    /// The Taylor series, whose next terms are below 3·10⁻⁹ there.
    #[inline(always)]
    fn sin_cos_eighth(self) -> (Self, Self) {
        const SINE: [f32; 4] = [-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0];
        const COSINE: [f32; 5] =
            [-0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0];
        let square = self * self;
        let sine = self + self * (square * square.polynomial(&SINE));
        (sine, square * square.polynomial(&COSINE) + 1.0)
    }

    /// Sine and cosine of 2πx, for |x| below 2²², within two roundings of 1.
    ///
    /// The nearest integer and the nearest quarter are subtracted exactly.
    #[inline(always)]
    fn sin_cos_turn(self) -> (Self, Self) {
        let rest = self - self.nearest();
        // From −2 to 2. Odd quarters swap sine and cosine, halves negate both.
        let quarters = (rest * 4.0).nearest();
        let (sine, cosine) = ((rest - quarters * 0.25) * TAU).sin_cos_eighth();
        let square = quarters * quarters;
        let (is_odd, is_half) = (square.equals(square.like(1.0)), square.above(2.0));
        let y = Self::select(is_odd, cosine * quarters, sine);
        let x = Self::select(is_odd, -sine * quarters, cosine);
        (Self::select(is_half, -y, y), Self::select(is_half, -x, x))
    }
}

/// The spacing of floats of this size is 1: 1.5 · 2²³. The low bits of its sum with an integer n
/// from −2²² to 2²² are those of n, in two's complement.
pub(super) const NO_FRACTION: f32 = 12_582_912.0;
/// The biased exponent of 1.
pub(super) const ONE_EXPONENT: i32 = 127;
/// The number of mantissa bits.
pub(super) const MANTISSA_BITS: u32 = 23;
pub(super) const MANTISSA_MASK: u32 = (1 << MANTISSA_BITS) - 1;

/// ln 2 in two parts. The first has so few bits that its products with exponents are exact.
const LN_2_HIGH: f32 = 0.693_359_4;
const LN_2_LOW: f32 = -2.121_944_4e-4;

/// Outside of this range, e^x is taken as zero or infinity; inside, its exponent is normal.
const EXP_RANGE: [f32; 2] = [-87.0, 88.0];

impl Real for f32 {
    type Mask = bool;

    #[inline(always)]
    fn like(self, value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        f32::copysign(self, sign)
    }

    #[inline(always)]
    fn floor(self) -> Self {
        // Not `f32::floor`, which is a library call on machines without the instruction.
        let truncated = (self as i32 as f32).copysign(self);
        if truncated > self { truncated - 1.0 } else { truncated }
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        let exponent = (self + NO_FRACTION).to_bits() << MANTISSA_BITS;
        f32::from_bits(exponent.wrapping_add(1.0_f32.to_bits()))
    }

    #[inline(always)]
    fn mantissa_and_exponent(self) -> (Self, Self) {
        let bits = self.to_bits();
        let mantissa = f32::from_bits(bits & MANTISSA_MASK | 1.0_f32.to_bits());
        (mantissa, ((bits >> MANTISSA_BITS) as i32 - ONE_EXPONENT) as f32)
    }

    #[inline(always)]
    fn next_up(self) -> Self {
        f32::next_up(self)
    }

    #[inline(always)]
    fn next_down(self) -> Self {
        f32::next_down(self)
    }

    #[inline(always)]
    fn next_towards(self, direction: Self) -> Self {
        if direction > 0.0 {
            f32::next_up(self)
        } else if direction < 0.0 {
            f32::next_down(self)
        } else {
            self
        }
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn equals(self, other: Self) -> bool {
        self == other
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The greatest error in ulps over `COUNT` steps from `low` to `high`.
    fn max_error(
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
    fn exp_is_accurate_to_two_ulps() {
        for range in [[-1.0, 1.0], [-20.0, 20.0], EXP_RANGE] {
            let error = max_error(range, <f32 as Real>::exp, f64::exp);
            assert!(error < 2.0, "{range:?}: {error}");
        }
        assert_eq!((Real::exp(0.0_f32), Real::exp(-88.0_f32)), (1.0, 0.0));
        assert_eq!((Real::exp(f32::NEG_INFINITY), Real::exp(f32::INFINITY)), (0.0, f32::INFINITY));
        assert!(Real::exp(f32::NAN).is_nan());
    }

    #[test]
    fn ln_is_accurate_to_two_ulps() {
        for range in [[f32::MIN_POSITIVE, 1e-30], [1e-6, 0.1], [0.1, 3.0], [0.999, 1.001]] {
            let error = max_error(range, <f32 as Real>::ln, f64::ln);
            assert!(error < 2.0, "{range:?}: {error}");
        }
        assert!(max_error([1.0, f32::MAX], <f32 as Real>::ln, f64::ln) < 2.0);
        assert_eq!(Real::ln(1.0_f32), 0.0);
    }

    #[test]
    fn sine_and_cosine_are_accurate_to_two_roundings() {
        for step in -4000_i16..=4000 {
            let turns = f32::from(step) / 1999.0;
            let (sine, cosine) = Real::sin_cos_turn(turns);
            let (true_sine, true_cosine) = (f64::from(turns) * std::f64::consts::TAU).sin_cos();
            assert!((f64::from(sine) - true_sine).abs() <= 1.2e-7, "{turns}");
            assert!((f64::from(cosine) - true_cosine).abs() <= 1.2e-7, "{turns}");
        }
        assert_eq!(Real::sin_cos_turn(0.25_f32), (1.0, 0.0));
        assert_eq!(Real::sin_cos_turn(-0.5_f32).1, -1.0);
    }
}
