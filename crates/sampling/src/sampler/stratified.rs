//! Jittered strata in shuffled order.

use super::state::{Sampler, in_stratum};
use crate::hash::{permute, unit_float};
use glam::Vec2;

/// The smallest square grid with at least `planned` strata.
pub(super) fn grid(planned: u32) -> (u32, u32) {
    let side = f64::from(planned).sqrt().ceil() as u32;
    (side, side)
}

/// One of as many strata as the set has samples, with a random offset.
#[inline]
pub(super) fn next_1d(sampler: &Sampler) -> f32 {
    let (seed, _) = sampler.set_seeds();
    let stratum = permute(sampler.index, sampler.sets.count, seed);
    in_stratum(stratum, unit_float((sampler.jitter() >> 32) as u32), sampler.sets.count)
}

/// One cell of the grid, with a random point inside.
#[inline]
pub(super) fn next_2d(sampler: &Sampler) -> Vec2 {
    let (seed, _) = sampler.set_seeds();
    let stratum = permute(sampler.index, sampler.sets.count, seed);
    let (columns, rows) = (sampler.sets.columns, sampler.sets.rows);
    let jitter = sampler.jitter();
    Vec2::new(
        in_stratum(stratum % columns, unit_float((jitter >> 32) as u32), columns),
        in_stratum(stratum / columns, unit_float(jitter as u32), rows),
    )
}
