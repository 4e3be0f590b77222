//! Floats in lanes.

use super::level::MAX_LANES;
use super::mask::LaneMask;
use super::real::{MANTISSA_BITS, MANTISSA_MASK, NO_FRACTION, ONE_EXPONENT, Real};
use fearless_simd::{Simd, prelude::*};
use std::ops::{Add, Div, Mul, Neg, Sub};

const SIGN_BIT: u32 = 1 << 31;

/// An array in memory with room for the widest lanes.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct LaneArray(pub [f32; MAX_LANES]);

impl LaneArray {
    /// All zeros.
    pub const ZERO: Self = Self([0.0; MAX_LANES]);
}

impl Default for LaneArray {
    fn default() -> Self {
        Self::ZERO
    }
}

/// A float per lane.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd>(pub(super) S::f32s);

impl<S: Simd> Lanes<S> {
    /// The number of lanes, a divisor of [`MAX_LANES`].
    pub const COUNT: usize = <S::f32s as SimdBase<S>>::LEN;

    /// The same value in all lanes.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, value: f32) -> Self {
        Self(S::f32s::splat(simd, value))
    }

    /// Loads the elements of an array from index `first` on, a multiple of [`Self::COUNT`].
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, array: &LaneArray, first: usize) -> Self {
        Self(S::f32s::from_slice(simd, &array.0[first..first + Self::COUNT]))
    }

    /// Stores to the elements of an array from index `first` on.
    #[inline(always)]
    pub fn store(self, array: &mut LaneArray, first: usize) {
        self.0.store_slice(&mut array.0[first..first + Self::COUNT]);
    }

    /// A value computed for each lane.
    #[inline(always)]
    #[must_use]
    pub fn from_fn(simd: S, lane: impl FnMut(usize) -> f32) -> Self {
        Self(S::f32s::from_fn(simd, lane))
    }

    /// The value in one lane.
    #[inline(always)]
    #[must_use]
    pub fn lane(&self, lane: usize) -> f32 {
        self.0.as_slice()[lane]
    }

    #[inline(always)]
    pub(super) fn bits(self) -> S::u32s {
        self.0.bitcast()
    }

    /// The next number in the direction of `sign`: 0 for up, the sign bit for down.
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
