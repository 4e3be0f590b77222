//! The (0, 2)-sequence in base 2, shuffled and digit-scrambled (Kollig and Keller, 2002).

use super::sobol::second_dimension_reversed;
use super::state::{Sampler, next_seed};
use crate::hash::{permute, unit_float};
use etendue_math::lanes::Word64 as _;
use glam::Vec2;

#[inline]
pub(super) fn next_1d(sampler: &Sampler) -> f32 {
    let (seed, scramble) = sampler.set_seeds();
    let index = permute(sampler.index, sampler.sets.count, seed);
    unit_float(index.reverse_bits() ^ scramble)
}

#[inline]
pub(super) fn next_2d(sampler: &Sampler) -> Vec2 {
    let bits = sampler.set_bits();
    let (seed, scramble) = (bits.upper(), bits.lower());
    let index = permute(sampler.index, sampler.sets.count, seed);
    Vec2::new(
        unit_float(index.reverse_bits() ^ scramble),
        unit_float(second_dimension_reversed(index).reverse_bits() ^ next_seed(bits)),
    )
}
