//! Integer mixing, hashed permutations, and the conversion of bits to numbers in [0, 1).
//!
//! Functions that samplers use in lanes are generic over words of any number of lanes; a `u32` or `u64`
//! is one lane.

use etendue_math::lanes::{Word32, Word64};

/// The greatest single-precision number below one.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// 2⁶⁴ divided by the golden ratio: any number of successive multiples is spread evenly.
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The upper 24 of 32 random bits as a number in [0, 1): every value is exact and below one.
#[inline(always)]
#[must_use]
pub fn unit_float<W: Word32>(bits: W) -> W::Real {
    (bits >> 8).to_real() * (1.0 / 16_777_216.0)
}

/// A bijection of 32-bit integers in which every input bit flips every output bit about half the
/// time (Wellons' `lowbias32` in its second edition; bias 0.107).
#[inline]
#[must_use]
pub fn mix32(value: u32) -> u32 {
    let value = (value ^ (value >> 16)).wrapping_mul(0x21f0_aaad);
    let value = (value ^ (value >> 15)).wrapping_mul(0x735a_2d97);
    value ^ (value >> 15)
}

/// A bijection of 64-bit integers with full avalanche (Stafford's variant 13 of the MurmurHash3
/// finaliser, as in SplitMix64).
#[inline(always)]
#[must_use]
pub fn mix64<W: Word64>(value: W) -> W {
    let value = (value ^ (value >> 30)).times(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ (value >> 27)).times(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

/// The place of `index` in a permutation of 0..`length` picked by `seed`; any index is taken modulo
/// `length`, and a length of zero gives zero.
///
/// A bijection of the next power of two, repeated until the result lies below `length`: fewer than two
/// rounds on average (the scheme of Kensler, *Correlated Multi-Jittered Sampling*, 2013). His own
/// bijection reaches only some of the permutations of four or eight elements; in this one every
/// factor depends on the seed.
#[inline]
#[must_use]
pub fn permute(index: u32, length: u32, seed: u32) -> u32 {
    if length <= 1 {
        return 0;
    }
    let mask = u32::MAX >> (length - 1).leading_zeros();
    let shift = mask.count_ones().div_ceil(2).max(2);
    let keys = mix64(u64::from(seed).wrapping_add(1).wrapping_mul(GOLDEN));
    let mut place = if index < length { index } else { index % length };
    loop {
        place = permute_masked(place, keys, mask, shift);
        if place < length {
            break;
        }
    }
    // A final rotation makes every place equally likely over the seeds.
    let rotation = ((u64::from(keys as u32) * u64::from(length)) >> 32) as u32;
    let rotated = u64::from(place) + u64::from(rotation);
    let excess = if rotated < u64::from(length) { 0 } else { u64::from(length) };
    (rotated - excess) as u32
}

/// One bijection of the integers under `mask`: five rounds of a difference, an odd factor and
/// two shifts, each with its own piece of the keys.
#[inline]
fn permute_masked(value: u32, keys: u64, mask: u32, shift: u32) -> u32 {
    let mut value = value;
    let mut key = keys;
    for _ in 0..5 {
        let factor = (key >> 31) as u32 | 1;
        value = (value ^ key as u32).wrapping_mul(factor) & mask;
        value ^= value >> shift;
        value ^= value >> 1;
        key = key.rotate_right(13);
    }
    value
}

/// A nested uniform scramble in which each bit is flipped by a hash of the *lower* bits: the digits
/// of the number are read from the lowest bit up.
///
/// The hash of Laine and Karras with the constants found by Vegdahl (Burley, *Practical Hash-based
/// Owen Scrambling*, JCGT 2020, section 2, and Vegdahl's note on it, 2021).
#[inline(always)]
#[must_use]
pub fn scramble_reversed<W: Word32>(value: W, seed: W) -> W {
    let mut value = value;
    value = value ^ value.times(0x3d20_adea);
    value = value.wrapping_add(seed);
    value = value.wrapping_mul((seed >> 16) | 1);
    value = value ^ value.times(0x0552_6c56);
    value ^ value.times(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::chi2_discrete;

    #[test]
    fn floats_stay_below_one() {
        assert_eq!(unit_float(0), 0.0);
        assert_eq!(unit_float(u32::MAX), ONE_MINUS_EPSILON);
        const { assert!(ONE_MINUS_EPSILON < 1.0) };
        assert_eq!(ONE_MINUS_EPSILON.next_up(), 1.0);
    }

    #[test]
    fn mixing_avalanches() {
        // Each input bit flips each output bit in about half of the trials.
        for input in 0..32 {
            let mut flips32 = [0_u32; 32];
            let mut flips64 = [0_u32; 64];
            for trial in 0..4000_u32 {
                let change = mix32(trial) ^ mix32(trial ^ (1 << input));
                let wide = mix64(u64::from(trial)) ^ mix64(u64::from(trial) ^ (1 << input));
                (0..32).for_each(|bit| flips32[bit] += change >> bit & 1);
                (0..64).for_each(|bit| flips64[bit] += (wide >> bit & 1) as u32);
            }
            // Standard deviation 32; counters differ in their low bits only, the hardest case.
            for flips in flips32.iter().chain(&flips64) {
                assert!(flips.abs_diff(2000) < 250, "bit {input}: {flips}");
            }
        }
    }

    #[test]
    fn permutations_hit_every_place_once() {
        for length in [1, 2, 3, 7, 16, 25, 100, 1000, 4096] {
            for seed in [0, 1, 0xdead_beef, u32::MAX] {
                let mut seen = vec![false; length as usize];
                for index in 0..length {
                    let place = permute(index, length, seed) as usize;
                    assert!(!std::mem::replace(&mut seen[place], true));
                }
            }
        }
        assert_eq!(permute(5, 0, 1), 0);
        assert!(permute(u32::MAX, 7, 1) < 7);
    }

    #[test]
    fn permutations_send_pairs_everywhere() {
        // Over many seeds, two neighbours reach all pairs of distinct places about equally often. The
        // hash is not a perfect shuffle: 25 % more or less passes, a pair that is never reached fails.
        const TRIALS: u32 = 400_000;
        for length in 3_u32..=16 {
            let mut counts = vec![0_u32; (length * length) as usize];
            for trial in 0..TRIALS {
                let seed = mix32(trial);
                let pair = (permute(0, length, seed), permute(1, length, seed));
                counts[(pair.0 * length + pair.1) as usize] += 1;
            }
            let even = f64::from(TRIALS) / f64::from(length * (length - 1));
            for (cell, &count) in counts.iter().enumerate() {
                let (first, second) = (cell as u32 / length, cell as u32 % length);
                let expected = if first == second { 0.0 } else { even };
                assert!(
                    (f64::from(count) - expected).abs() <= 0.25 * expected,
                    "{length}: {count}"
                );
            }
        }
    }

    #[test]
    fn scrambling_is_nested_and_fair() {
        // Two numbers that agree in their low bits still do so after scrambling, and differ first at
        // the same bit.
        let mut flipped = [0_u64; 2];
        for trial in 0..10_000 {
            let (value, seed) = (mix32(trial), mix32(trial ^ 0xabcd_0000));
            let low = trial % 31;
            let other = value ^ (mix32(!trial) << low | 1 << low);
            let difference = scramble_reversed(value, seed) ^ scramble_reversed(other, seed);
            assert_eq!(difference.trailing_zeros(), (value ^ other).trailing_zeros());
            flipped[(scramble_reversed(0, seed) & 1) as usize] += 1;
        }
        chi2_discrete(&flipped, &[1.0, 1.0]).assert();
    }
}
