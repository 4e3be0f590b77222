//! Owen-scrambled Sobol' points, two dimensions at a time (Burley, *Practical Hash-based Owen
//! Scrambling*, JCGT 2020).
//!
//! The index is shuffled by a nested uniform scramble of its own, which keeps every aligned block of
//! 2ᵐ samples a (0, m, 2)-net and makes the pairs of dimensions independent of each other. All work
//! is done on reversed bits, so that each coordinate is reversed once.

use super::{SampleStream, next_seed};
use crate::hash::{scramble_reversed, unit_float};
use glam::Vec2;

#[inline]
pub(super) fn next_1d(stream: &SampleStream) -> f32 {
    let (shuffle, scramble) = stream.set_seeds();
    let index = scramble_reversed(stream.index, shuffle).reverse_bits();
    unit_float(scramble_reversed(index, scramble).reverse_bits())
}

#[inline]
pub(super) fn next_2d(stream: &SampleStream) -> Vec2 {
    let (shuffle, scramble) = stream.set_seeds();
    let index = scramble_reversed(stream.index, shuffle).reverse_bits();
    let second = second_dimension_reversed(index);
    let x = scramble_reversed(index, scramble);
    let y = scramble_reversed(second, next_seed(shuffle, scramble));
    // One reversal for both: the halves change places.
    let both = (u64::from(x) | u64::from(y) << 32).reverse_bits();
    Vec2::new(unit_float((both >> 32) as u32), unit_float(both as u32))
}

/// The second Sobol' coordinate of point `index` as a 32-bit fraction with its bits reversed.
///
/// Its matrix is Pascal's triangle modulo 2, which factors into five steps of doubled shifts (Ahmed,
/// *An Implementation Algorithm of 2D Sobol Sequence Fast, Elegant, and Compact*, EGSR 2024).
#[inline]
pub(super) fn second_dimension_reversed(index: u32) -> u32 {
    let mut bits = index;
    bits ^= (bits & 0xffff_0000) >> 16;
    bits ^= (bits & 0xff00_ff00) >> 8;
    bits ^= (bits & 0xf0f0_f0f0) >> 4;
    bits ^= (bits & 0xcccc_cccc) >> 2;
    bits ^= (bits & 0xaaaa_aaaa) >> 1;
    bits
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
