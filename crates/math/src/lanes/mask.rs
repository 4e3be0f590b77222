//! Masks: one boolean per lane.

use fearless_simd::{Simd, prelude::*};
use std::ops::{BitAnd, BitOr, Not};

/// A boolean, or one per lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Whether any lane is true.
    fn any(self) -> bool;
    /// Whether all lanes are true.
    fn all(self) -> bool;
    /// One bit per lane, the first lane in the lowest bit.
    fn bits(self) -> u32;
}

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }

    #[inline(always)]
    fn all(self) -> bool {
        self
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

/// A boolean per lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneMask<S: Simd>(pub(super) S::mask32s);

impl<S: Simd> LaneMask<S> {
    /// The mask with the given bits, the first lane in the lowest bit.
    #[inline(always)]
    #[must_use]
    pub fn from_bits(simd: S, bits: u32) -> Self {
        let lanes = <S::f32s as SimdBase<S>>::LEN;
        Self(S::mask32s::from_bitmask(simd, u64::from(bits) & ((1 << lanes) - 1)))
    }
}

impl<S: Simd> BitAnd for LaneMask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl<S: Simd> BitOr for LaneMask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl<S: Simd> Not for LaneMask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl<S: Simd> Mask for LaneMask<S> {
    #[inline(always)]
    fn any(self) -> bool {
        self.0.any_true()
    }

    #[inline(always)]
    fn all(self) -> bool {
        self.0.all_true()
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.to_bitmask() as u32
    }
}
