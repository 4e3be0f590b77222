//! A sampler's state, and the hashes that its numbers come from.

use super::kind::{SampleSets, SamplerKind};
use crate::hash::{GOLDEN, ONE_MINUS_EPSILON, mix64, unit_float};
use etendue_math::lanes::{Vector2, Word32, Word64};

/// Draws the random numbers of one sample of one pixel; made by
/// [`SamplerSpec::start`](crate::SamplerSpec::start).
///
/// A copy draws the same numbers from there on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    pub(super) kind: SamplerKind,
    pub(super) dimension: u32,
    /// The index of the sample in its set; with its bits reversed for Sobol'.
    pub(super) index: u32,
    pub(super) sets: SampleSets,
    /// A hash of seed, pixel and set.
    pub(super) set_seed: u64,
    /// A hash of seed, pixel, set and sample.
    pub(super) sample_seed: u64,
}

/// Dimensions from here on are independent for every kind. Film, lens and two vertices of six numbers
/// each come before. What a path does later is not a smooth function of its numbers, so spreading
/// them gains nothing, and a spread pair takes four times as long to draw.
const SPREAD_DIMENSIONS: u32 = 16;

impl Sampler {
    /// The dimension of the next number.
    #[inline]
    #[must_use]
    pub fn dimension(&self) -> u32 {
        self.dimension
    }

    /// Jumps to a dimension, forward or back. The numbers that follow depend on it alone.
    #[inline]
    pub fn set_dimension(&mut self, dimension: u32) {
        self.dimension = dimension;
    }

    /// Whether the next number is independent of the other samples.
    #[inline]
    pub(super) fn is_independent(&self) -> bool {
        is_independent(self.kind, self.dimension)
    }

    /// 64 bits that no other dimension, sample, pixel or seed shares.
    #[inline]
    pub(super) fn jitter(&self) -> u64 {
        bits_of_dimension(self.sample_seed, self.dimension)
    }

    /// Two seeds for this dimension that all samples of the set share.
    #[inline]
    pub(super) fn set_seeds(&self) -> (u32, u32) {
        let bits = self.set_bits();
        (bits.upper(), bits.lower())
    }

    /// [`Self::set_seeds`] as one number, the first in the upper half.
    #[inline]
    pub(super) fn set_bits(&self) -> u64 {
        bits_of_dimension(self.set_seed, self.dimension)
    }
}

/// Whether numbers of this dimension are independent of the other samples.
#[inline(always)]
pub(super) fn is_independent(kind: SamplerKind, dimension: u32) -> bool {
    dimension >= SPREAD_DIMENSIONS || kind == SamplerKind::Independent
}

/// 64 bits for a dimension of a seed.
#[inline(always)]
pub(super) fn bits_of_dimension<W: Word64>(seed: W, dimension: u32) -> W {
    mix64(seed.plus(u64::from(dimension).wrapping_mul(GOLDEN)))
}

/// A point from 64 bits.
#[inline(always)]
pub(super) fn point_of_bits<W: Word64>(bits: W) -> Vector2<<W::Half as Word32>::Real> {
    Vector2::new(unit_float(bits.upper()), unit_float(bits.lower()))
}

/// A third seed from two: the upper half of a product depends on all of their bits.
#[inline(always)]
pub(super) fn next_seed<W: Word64>(seeds: W) -> W::Half {
    seeds.times(0xd134_2543_de82_ef95).upper()
}

/// The number at share `offset` of stratum `stratum` out of `count`; rounding never reaches one.
#[inline]
pub(super) fn in_stratum(stratum: u32, offset: f32, count: u32) -> f32 {
    // In double precision: single precision cannot tell all strata apart.
    let value = (f64::from(stratum) + f64::from(offset)) / f64::from(count);
    (value as f32).min(ONE_MINUS_EPSILON)
}
