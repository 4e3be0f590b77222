//! Correlated multi-jittered samples (Kensler, *Correlated Multi-Jittered Sampling*, 2013).

use super::state::{Sampler, in_stratum, next_seed};
use crate::hash::{permute, unit_float};
use etendue_math::lanes::Word64 as _;
use glam::Vec2;

/// The grid nearest to a square, not wider than high, with at least `planned` cells.
pub(super) fn grid(planned: u32) -> (u32, u32) {
    let columns = (f64::from(planned).sqrt() as u32).max(1);
    (columns, planned.div_ceil(columns))
}

/// A point in one cell of the grid. All cells of a column share one permutation of the sub-columns,
/// and all of a row one of the sub-rows, which makes each projection a stratified one.
#[inline]
pub(super) fn next_2d(sampler: &Sampler) -> Vec2 {
    let (columns, rows) = (sampler.sets.columns, sampler.sets.rows);
    let seeds = sampler.set_bits();
    let (seed, seed_columns) = (seeds.upper(), seeds.lower());
    let stratum = permute(sampler.index, sampler.sets.count, seed);
    let (column, row) = (stratum % columns, stratum / columns);
    let sub_column = permute(row, rows, seed_columns);
    let sub_row = permute(column, columns, next_seed(seeds));
    let jitter = sampler.jitter();
    let x = unit_float((jitter >> 32) as u32);
    let y = unit_float(jitter as u32);
    Vec2::new(
        in_stratum(column * rows + sub_column, x, sampler.sets.count),
        in_stratum(row * columns + sub_row, y, sampler.sets.count),
    )
}
