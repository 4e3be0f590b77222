//! Owen-scrambled Sobol' points, two dimensions at a time (Burley, *Practical Hash-based Owen
//! Scrambling*, JCGT 2020).
//!
//! The index is shuffled by a nested uniform scramble of its own, which keeps every aligned block of
//! 2ᵐ samples a (0, m, 2)-net and makes the pairs of dimensions independent of each other. All work
//! is done on reversed bits, so that each coordinate is reversed once.

use super::state::{Sampler, next_seed};
use crate::hash::{scramble_reversed, unit_float};
use etendue_math::lanes::{Vector2, Word32, Word64};
use glam::Vec2;

#[inline]
pub(super) fn next_1d(sampler: &Sampler) -> f32 {
    let (shuffle, scramble) = sampler.set_seeds();
    let index = scramble_reversed(sampler.index, shuffle).reverse_bits();
    unit_float(scramble_reversed(index, scramble).reverse_bits())
}

#[inline]
pub(super) fn next_2d(sampler: &Sampler) -> Vec2 {
    point(sampler.index, sampler.set_bits()).into()
}

/// The point of a sample, given its index with the bits reversed and the seeds of its set.
#[inline(always)]
pub(super) fn point<W: Word64>(index: W::Half, seeds: W) -> Vector2<<W::Half as Word32>::Real> {
    let (shuffle, scramble) = (seeds.upper(), seeds.lower());
    let index = scramble_reversed(index, shuffle).reverse_bits();
    let second = second_dimension_reversed(index);
    let x = scramble_reversed(index, scramble);
    let y = scramble_reversed(second, next_seed(seeds));
    let [x, y] = Word32::reverse_bits_of_both(x, y);
    Vector2::new(unit_float(x), unit_float(y))
}

/// The second Sobol' coordinate of point `index` as a 32-bit fraction with its bits reversed.
///
/// Its matrix is Pascal's triangle modulo 2, which factors into five steps of doubled shifts (Ahmed,
/// *An Implementation Algorithm of 2D Sobol Sequence Fast, Elegant, and Compact*, EGSR 2024).
#[inline(always)]
pub(super) fn second_dimension_reversed<W: Word32>(index: W) -> W {
    let mut bits = index;
    bits = bits ^ ((bits & 0xffff_0000) >> 16);
    bits = bits ^ ((bits & 0xff00_ff00) >> 8);
    bits = bits ^ ((bits & 0xf0f0_f0f0) >> 4);
    bits = bits ^ ((bits & 0xcccc_cccc) >> 2);
    bits ^ ((bits & 0xaaaa_aaaa) >> 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_dimension_follows_the_recurrence() {
        // Direction numbers of the primitive polynomial x + 1: v₁ = 1/2, vₖ = vₖ₋₁ ^ (vₖ₋₁ >> 1).
        let mut directions = [0x8000_0000_u32; 32];
        for k in 1..32 {
            directions[k] = directions[k - 1] ^ (directions[k - 1] >> 1);
        }
        for index in (0..5000).chain([u32::MAX, 0x8000_0000, 0x1234_5678]) {
            let expected = (0..32)
                .filter(|bit| index >> bit & 1 == 1)
                .fold(0, |sum, bit| sum ^ directions[bit as usize]);
            assert_eq!(second_dimension_reversed(index).reverse_bits(), expected, "{index}");
        }
    }
}
