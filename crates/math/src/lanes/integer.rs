//! Unsigned integers, one or one per lane: for hashes and bit manipulation.

use super::float::Lanes;
use super::level::MAX_LANES;
use super::real::Real;
use fearless_simd::{Simd, prelude::*};
use std::ops::{BitAnd, BitOr, BitXor, Shl, Shr};

/// An unsigned integer with wrapping arithmetic, or one per lane.
pub trait Word:
    Copy
    + BitXor<Output = Self>
    + BitOr<Output = Self>
    + BitOr<Self::Constant, Output = Self>
    + BitAnd<Self::Constant, Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
    /// The integer type of one lane.
    type Constant;

    /// The wrapping sum.
    fn wrapping_add(self, other: Self) -> Self;
    /// The wrapping product.
    fn wrapping_mul(self, other: Self) -> Self;
    /// The wrapping sum with a constant.
    fn plus(self, constant: Self::Constant) -> Self;
    /// The wrapping product with a constant.
    fn times(self, constant: Self::Constant) -> Self;
}

/// A 32-bit unsigned integer, or one per lane.
pub trait Word32: Word<Constant = u32> {
    /// The floats with the same number of lanes.
    type Real: Real;

    /// Converts to a float. The value must be below 2²⁴, so the result is exact.
    fn to_real(self) -> Self::Real;

    /// The bits in reverse order.
    #[inline(always)]
    fn reverse_bits(self) -> Self {
        let mut bits = self;
        bits = (bits & 0x5555_5555) << 1 | (bits >> 1) & 0x5555_5555;
        bits = (bits & 0x3333_3333) << 2 | (bits >> 2) & 0x3333_3333;
        bits = (bits & 0x0f0f_0f0f) << 4 | (bits >> 4) & 0x0f0f_0f0f;
        bits = (bits & 0x00ff_00ff) << 8 | (bits >> 8) & 0x00ff_00ff;
        bits << 16 | bits >> 16
    }

    /// The bits of two numbers in reverse order.
    #[inline(always)]
    fn reverse_bits_of_both(first: Self, second: Self) -> [Self; 2] {
        [first.reverse_bits(), second.reverse_bits()]
    }
}

/// A 64-bit unsigned integer, or one per lane.
pub trait Word64: Word<Constant = u64> {
    /// The 32-bit integers with the same number of lanes.
    type Half: Word32;

    /// The upper 32 bits.
    fn upper(self) -> Self::Half;
    /// The lower 32 bits.
    fn lower(self) -> Self::Half;
}

macro_rules! single {
    ($type:ident) => {
        impl Word for $type {
            type Constant = $type;

            #[inline(always)]
            fn wrapping_add(self, other: Self) -> Self {
                $type::wrapping_add(self, other)
            }

            #[inline(always)]
            fn wrapping_mul(self, other: Self) -> Self {
                $type::wrapping_mul(self, other)
            }

            #[inline(always)]
            fn plus(self, constant: Self) -> Self {
                $type::wrapping_add(self, constant)
            }

            #[inline(always)]
            fn times(self, constant: Self) -> Self {
                $type::wrapping_mul(self, constant)
            }
        }
    };
}

single!(u32);
single!(u64);

impl Word32 for u32 {
    type Real = f32;

    #[inline(always)]
    fn to_real(self) -> f32 {
        self as f32
    }

    #[inline(always)]
    fn reverse_bits(self) -> Self {
        u32::reverse_bits(self)
    }

    #[inline(always)]
    fn reverse_bits_of_both(first: Self, second: Self) -> [Self; 2] {
        // One 64-bit reversal for both, which also swaps the halves.
        let both = (u64::from(first) | u64::from(second) << 32).reverse_bits();
        [both.upper(), both.lower()]
    }
}

impl Word64 for u64 {
    type Half = u32;

    #[inline(always)]
    fn upper(self) -> u32 {
        (self >> 32) as u32
    }

    #[inline(always)]
    fn lower(self) -> u32 {
        self as u32
    }
}

/// An array of 32-bit integers in memory with room for the widest lanes.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub struct WordArray32(pub [u32; MAX_LANES]);

/// An array of 64-bit integers in memory with room for the widest lanes.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub struct WordArray64(pub [u64; MAX_LANES]);

/// A 32-bit integer per lane.
#[derive(Clone, Copy, Debug)]
pub struct WordLanes32<S: Simd>(S::u32s);

/// A 64-bit integer per lane, in two registers.
#[derive(Clone, Copy, Debug)]
pub struct WordLanes64<S: Simd>([S::u64s; 2]);

impl<S: Simd> WordLanes32<S> {
    /// Loads from an array; see [`Lanes::load`].
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, array: &WordArray32, first: usize) -> Self {
        Self(S::u32s::from_slice(simd, &array.0[first..first + Lanes::<S>::COUNT]))
    }

    /// Stores to an array; see [`Lanes::store`].
    #[inline(always)]
    pub fn store(self, array: &mut WordArray32, first: usize) {
        self.0.store_slice(&mut array.0[first..first + Lanes::<S>::COUNT]);
    }
}

impl<S: Simd> WordLanes64<S> {
    /// Loads from an array; see [`Lanes::load`].
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, array: &WordArray64, first: usize) -> Self {
        let (low, high) = array.0[first..first + Lanes::<S>::COUNT].split_at(Lanes::<S>::COUNT / 2);
        Self([S::u64s::from_slice(simd, low), S::u64s::from_slice(simd, high)])
    }
}

macro_rules! operators {
    ($lanes:ident: $($operation:ident $function:ident $operand:ty, |$a:ident, $b:ident| $result:expr;)*) => {
        $(impl<S: Simd> $operation<$operand> for $lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: $operand) -> Self {
                let ($a, $b) = (self, other);
                $result
            }
        })*
    };
}

operators! { WordLanes32:
    BitXor bitxor Self, |a, b| Self(a.0 ^ b.0);
    BitOr bitor Self, |a, b| Self(a.0 | b.0);
    BitOr bitor u32, |a, b| Self(a.0 | b);
    BitAnd bitand u32, |a, b| Self(a.0 & b);
    Shl shl u32, |a, b| Self(a.0 << b);
    Shr shr u32, |a, b| Self(a.0 >> b);
}

operators! { WordLanes64:
    BitXor bitxor Self, |a, b| Self([a.0[0] ^ b.0[0], a.0[1] ^ b.0[1]]);
    BitOr bitor Self, |a, b| Self([a.0[0] | b.0[0], a.0[1] | b.0[1]]);
    BitOr bitor u64, |a, b| Self([a.0[0] | b, a.0[1] | b]);
    BitAnd bitand u64, |a, b| Self([a.0[0] & b, a.0[1] & b]);
    Shl shl u32, |a, b| Self([a.0[0] << b, a.0[1] << b]);
    Shr shr u32, |a, b| Self([a.0[0] >> b, a.0[1] >> b]);
}

impl<S: Simd> Word for WordLanes32<S> {
    type Constant = u32;

    #[inline(always)]
    fn wrapping_add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }

    #[inline(always)]
    fn wrapping_mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }

    #[inline(always)]
    fn plus(self, constant: u32) -> Self {
        Self(self.0 + constant)
    }

    #[inline(always)]
    fn times(self, constant: u32) -> Self {
        Self(self.0 * constant)
    }
}

impl<S: Simd> Word for WordLanes64<S> {
    type Constant = u64;

    #[inline(always)]
    fn wrapping_add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1]])
    }

    #[inline(always)]
    fn wrapping_mul(self, other: Self) -> Self {
        Self([self.0[0] * other.0[0], self.0[1] * other.0[1]])
    }

    #[inline(always)]
    fn plus(self, constant: u64) -> Self {
        Self([self.0[0] + constant, self.0[1] + constant])
    }

    #[inline(always)]
    fn times(self, constant: u64) -> Self {
        Self([self.0[0] * constant, self.0[1] * constant])
    }
}

impl<S: Simd> Word32 for WordLanes32<S> {
    type Real = Lanes<S>;

    #[inline(always)]
    fn to_real(self) -> Lanes<S> {
        // As signed integers, whose conversion is an instruction on every machine.
        let signed: S::i32s = self.0.bitcast();
        Lanes(signed.to_float())
    }
}

impl<S: Simd> Word64 for WordLanes64<S> {
    type Half = WordLanes32<S>;

    #[inline(always)]
    fn upper(self) -> WordLanes32<S> {
        (self >> 32).lower()
    }

    #[inline(always)]
    fn lower(self) -> WordLanes32<S> {
        let [low, high] = self.0;
        WordLanes32(low.narrow(high))
    }
}
