//! Halton's sequence with Owen-scrambled digits.
//!
//! Each digit goes through a permutation hashed from the digits before it (nested uniform scrambling
//! in the base). After the bases run out, they serve again with the index shuffled.

use super::state::Sampler;
use crate::hash::{
    GOLDEN, ONE_MINUS_EPSILON, mix32, mix64, permute, scramble_reversed, unit_float,
};
use glam::Vec2;

/// How many primes serve as bases.
const BASE_COUNT: u32 = 64;
/// The first primes.
const BASES: [u32; BASE_COUNT as usize] = first_primes();
/// Digits are taken until their number of values passes this, the precision of the result.
const RESOLUTION: u64 = 1 << 24;

const fn first_primes() -> [u32; BASE_COUNT as usize] {
    let mut primes = [2; BASE_COUNT as usize];
    let mut count = 1;
    let mut candidate = 3;
    while count < primes.len() {
        let mut index = 0;
        while index < count && candidate % primes[index] != 0 {
            index += 1;
        }
        if index == count {
            primes[count] = candidate;
            count += 1;
        }
        candidate += 2;
    }
    primes
}

#[inline]
pub(super) fn next_1d(sampler: &Sampler) -> f32 {
    coordinate(sampler, sampler.dimension)
}

#[inline]
pub(super) fn next_2d(sampler: &Sampler) -> Vec2 {
    Vec2::new(
        coordinate(sampler, sampler.dimension),
        coordinate(sampler, sampler.dimension.wrapping_add(1)),
    )
}

#[inline]
fn coordinate(sampler: &Sampler, dimension: u32) -> f32 {
    let group = dimension / BASE_COUNT;
    let index = if group == 0 {
        sampler.index
    } else {
        let seed = mix64(sampler.set_seed ^ u64::from(group).wrapping_mul(GOLDEN)) as u32;
        scramble_reversed(sampler.index.reverse_bits(), seed).reverse_bits()
    };
    let key = u64::from(dimension).wrapping_add(1).wrapping_mul(GOLDEN);
    let seed = mix64(sampler.set_seed.wrapping_add(key)) as u32;
    match dimension % BASE_COUNT {
        0 => unit_float(scramble_reversed(index, seed).reverse_bits()),
        place => scrambled_radical_inverse(index, BASES[place as usize], seed),
    }
}

/// The radical inverse of `index` to `base` under nested uniform scrambling.
fn scrambled_radical_inverse(index: u32, base: u32, seed: u32) -> f32 {
    let mut rest = index;
    // The digits so far, and how many values they could have.
    let (mut digits, mut values) = (0_u64, 1_u64);
    while values < RESOLUTION {
        let prefix = (digits + values) as u32;
        let digit = permute(rest % base, base, mix32(seed ^ mix32(prefix)));
        digits = digits * u64::from(base) + u64::from(digit);
        values *= u64::from(base);
        rest /= base;
    }
    ((digits as f64 / values as f64) as f32).min(ONE_MINUS_EPSILON)
}
