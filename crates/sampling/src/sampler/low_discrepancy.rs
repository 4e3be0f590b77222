//! The (0, 2)-sequence in base 2, shuffled and digit-scrambled (Kollig and Keller, 2002).

use super::{Sampler, next_seed};
use crate::hash::{permute, unit_float};
use crate::sampler::sobol::second_dimension_reversed;
use etendue_math::lanes::Word64 as _;
use glam::Vec2;

#[inline]
pub(super) fn next_1d(stream: &Sampler) -> f32 {
    let (seed, scramble) = stream.set_seeds();
    let index = permute(stream.index, stream.sets.count, seed);
    unit_float(index.reverse_bits() ^ scramble)
}

#[inline]
pub(super) fn next_2d(stream: &Sampler) -> Vec2 {
    let bits = stream.set_bits();
    let (seed, scramble) = (bits.upper(), bits.lower());
    let index = permute(stream.index, stream.sets.count, seed);
    Vec2::new(
        unit_float(index.reverse_bits() ^ scramble),
        unit_float(second_dimension_reversed(index).reverse_bits() ^ next_seed(bits)),
    )
}
