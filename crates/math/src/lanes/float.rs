//! Single-precision numbers, one or several.

use super::MAX_LANES;
use super::functions;
use super::mask::{LaneMask, Mask};
use fearless_simd::{Simd, prelude::*};
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A single-precision number, or one for each lane.
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
    /// The answer to a comparison.
    type Mask: Mask;

    /// `value` in as many lanes as this number has.
    fn like(self, value: f32) -> Self;
    /// √x, correctly rounded.
    fn sqrt(self) -> Self;
    /// |x|.
    fn abs(self) -> Self;
    /// |x| with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// The greatest whole number not above x, for |x| below 2³¹.
    fn floor(self) -> Self;
    /// The nearest whole number, the even one of two, for |x| below 2²².
    #[inline(always)]
    fn nearest(self) -> Self {
        // The sum has no digits left behind the point.
        self + NO_FRACTION - NO_FRACTION
    }

    /// 2ⁿ for a whole number n from −126 to 127.
    fn power_of_two(self) -> Self;
    /// A positive normal number as m · 2ⁿ with m in [1, 2): (m, n).
    fn mantissa_and_exponent(self) -> (Self, Self);
    /// The next number above; +∞ and NaN stay as they are.
    fn next_up(self) -> Self;
    /// The next number below; −∞ and NaN stay as they are.
    fn next_down(self) -> Self;
    /// The next number above where `direction` is positive, the next below where it is negative, and
    /// the same where it is neither.
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

    /// Whether x is above a constant.
    #[inline(always)]
    fn above(self, bound: f32) -> Self::Mask {
        self.gt(self.like(bound))
    }

    /// Whether x is below a constant.
    #[inline(always)]
    fn below(self, bound: f32) -> Self::Mask {
        self.lt(self.like(bound))
    }

    /// The lesser of two; `other` where either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }

    /// The greater of two; `other` where either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.gt(other), self, other)
    }

    /// Zero in as many lanes as this number has.
    #[inline(always)]
    fn zero(self) -> Self {
        self.like(0.0)
    }

    /// 1 / x.
    #[inline(always)]
    fn reciprocal(self) -> Self {
        self.like(1.0) / self
    }

    /// √x, and zero where rounding has made x negative.
    #[inline(always)]
    fn safe_sqrt(self) -> Self {
        self.max(self.zero()).sqrt()
    }

    /// e^x within two units in the last place; zero below −87, and infinite above 88.
    #[inline(always)]
    fn exp(self) -> Self {
        functions::exp(self)
    }

    /// ln x within two units in the last place for a positive normal number; of others something
    /// finite, or NaN.
    #[inline(always)]
    fn ln(self) -> Self {
        functions::ln(self)
    }

    /// Sine and cosine of an angle between −π/4 and π/4, within two roundings of one.
    #[inline(always)]
    fn sin_cos_eighth(self) -> (Self, Self) {
        functions::sin_cos_eighth(self)
    }

    /// Sine and cosine of 2πx, a number of turns below 2²², within two roundings of one.
    #[inline(always)]
    fn sin_cos_turn(self) -> (Self, Self) {
        functions::sin_cos_turn(self)
    }

    /// The polynomial with the given coefficients, the constant first.
    #[inline(always)]
    fn polynomial<const COUNT: usize>(self, coefficients: &[f32; COUNT]) -> Self {
        functions::polynomial(self, coefficients)
    }
}

/// Between numbers of this size and the next there is nothing: 1.5 · 2²³. Of its sum with a whole
/// number n from −2²² to 2²² the last bits are those of n, in two's complement.
const NO_FRACTION: f32 = 12_582_912.0;
/// Exponent bits of 1.
const ONE_EXPONENT: i32 = 127;
/// Bits of the mantissa.
const MANTISSA_BITS: u32 = 23;
const SIGN_BIT: u32 = 1 << 31;
const MANTISSA_MASK: u32 = (1 << MANTISSA_BITS) - 1;

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
        // Without a call into the library where the machine has no such instruction.
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

/// As many numbers in memory as the widest lanes take.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct LaneArray(pub [f32; MAX_LANES]);

impl LaneArray {
    /// Zero everywhere.
    pub const ZERO: Self = Self([0.0; MAX_LANES]);
}

impl Default for LaneArray {
    fn default() -> Self {
        Self::ZERO
    }
}

/// A number for each lane.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd>(pub(super) S::f32s);

impl<S: Simd> Lanes<S> {
    /// How many lanes there are; [`MAX_LANES`] is a multiple of it.
    pub const COUNT: usize = <S::f32s as SimdBase<S>>::LEN;

    /// The same number in all lanes.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, value: f32) -> Self {
        Self(S::f32s::splat(simd, value))
    }

    /// Numbers from memory, from the place `first` of the array on, a multiple of [`Self::COUNT`].
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, array: &LaneArray, first: usize) -> Self {
        Self(S::f32s::from_slice(simd, &array.0[first..first + Self::COUNT]))
    }

    /// Numbers to memory, to the place `first` of the array and on.
    #[inline(always)]
    pub fn store(self, array: &mut LaneArray, first: usize) {
        self.0.store_slice(&mut array.0[first..first + Self::COUNT]);
    }

    /// Numbers made lane by lane.
    #[inline(always)]
    #[must_use]
    pub fn from_fn(simd: S, lane: impl FnMut(usize) -> f32) -> Self {
        Self(S::f32s::from_fn(simd, lane))
    }

    /// The number in one lane.
    #[inline(always)]
    #[must_use]
    pub fn lane(&self, lane: usize) -> f32 {
        self.0.as_slice()[lane]
    }

    #[inline(always)]
    pub(super) fn bits(self) -> S::u32s {
        self.0.bitcast()
    }

    /// The next number on the side of `sign`: 0 for upwards, the highest bit for downwards.
    #[inline(always)]
    fn step(self, sign: S::u32s) -> Self {
        let bits = self.bits();
        let simd = self.0.token();
        let outwards = (bits & SIGN_BIT).simd_eq(sign);
        let one = S::u32s::splat(simd, 1);
        let stepped: S::u32s = outwards.select(bits + one, bits - one);
        let least: S::u32s = sign | one;
        let is_zero = (bits & !SIGN_BIT).simd_eq(S::u32s::splat(simd, 0));
        let moved: S::u32s = is_zero.select(least, stepped);
        let stays = self.0.is_nan() | bits.simd_eq(sign | f32::INFINITY.to_bits());
        let result: S::u32s = stays.select(bits, moved);
        Self(result.bitcast())
    }
}

macro_rules! arithmetic {
    ($($operation:ident $function:ident $operator:tt;)*) => {
        $(impl<S: Simd> $operation for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }

        impl<S: Simd> $operation<f32> for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, constant: f32) -> Self {
                Self(self.0 $operator constant)
            }
        })*
    };
}

arithmetic! {
    Add add +;
    Sub sub -;
    Mul mul *;
    Div div /;
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<S: Simd> Real for Lanes<S> {
    type Mask = LaneMask<S>;

    #[inline(always)]
    fn like(self, value: f32) -> Self {
        Self(S::f32s::splat(self.0.token(), value))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self(self.0.copysign(sign.0))
    }

    #[inline(always)]
    fn floor(self) -> Self {
        Self(self.0.floor())
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        let bits = ((self + NO_FRACTION).bits() << MANTISSA_BITS) + 1.0_f32.to_bits();
        Self(bits.bitcast())
    }

    #[inline(always)]
    fn mantissa_and_exponent(self) -> (Self, Self) {
        let bits = self.bits();
        let mantissa: S::u32s = bits & MANTISSA_MASK | 1.0_f32.to_bits();
        let exponent: S::i32s = (bits >> MANTISSA_BITS).bitcast();
        (Self(mantissa.bitcast()), Self((exponent - ONE_EXPONENT).to_float()))
    }

    #[inline(always)]
    fn next_up(self) -> Self {
        self.step(S::u32s::splat(self.0.token(), 0))
    }

    #[inline(always)]
    fn next_down(self) -> Self {
        self.step(S::u32s::splat(self.0.token(), SIGN_BIT))
    }

    #[inline(always)]
    fn next_towards(self, direction: Self) -> Self {
        let moves = direction.abs().above(0.0);
        Self::select(moves, self.step(direction.bits() & SIGN_BIT), self)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask<S> {
        LaneMask(self.0.simd_lt(other.0))
    }

    #[inline(always)]
    fn le(self, other: Self) -> LaneMask<S> {
        LaneMask(self.0.simd_le(other.0))
    }

    #[inline(always)]
    fn equals(self, other: Self) -> LaneMask<S> {
        LaneMask(self.0.simd_eq(other.0))
    }

    #[inline(always)]
    fn is_finite(self) -> LaneMask<S> {
        LaneMask(self.0.is_finite())
    }

    #[inline(always)]
    fn select(mask: LaneMask<S>, yes: Self, no: Self) -> Self {
        Self(mask.0.select(yes.0, no.0))
    }
}
