//! Hammersley's point set, jittered and scrambled.

use super::state::{Sampler, in_stratum};
use crate::hash::{permute, scramble_reversed, unit_float};
use glam::Vec2;

/// Index / n with a random offset below 1/n, and the Owen-scrambled radical inverse in base 2.
#[inline]
pub(super) fn next_2d(sampler: &Sampler) -> Vec2 {
    let (seed, scramble) = sampler.set_seeds();
    let count = sampler.sets.count;
    let index = permute(sampler.index, count, seed);
    let offset = unit_float((sampler.jitter() >> 32) as u32);
    Vec2::new(
        in_stratum(index, offset, count),
        unit_float(scramble_reversed(index, scramble).reverse_bits()),
    )
}
