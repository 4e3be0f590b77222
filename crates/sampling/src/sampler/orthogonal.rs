//! Orthogonal array sampling (Jarosz, Enayet, Kensler, Kilpatrick and Christensen, *Orthogonal Array
//! Sampling for Monte Carlo Rendering*, 2019) with Bose's arrays of strength two.

use super::state::{Sampler, in_stratum};
use crate::hash::{GOLDEN, mix32, mix64, permute, unit_float};
use glam::Vec2;

/// p × p for the smallest prime p with at least `planned` cells.
pub(super) fn grid(planned: u32) -> (u32, u32) {
    let mut side = (f64::from(planned).sqrt().ceil() as u32).max(2);
    while !is_prime(side) {
        side += 1;
    }
    (side, side)
}

/// By division: the side is below 2¹⁶, so that some two hundred divisions decide.
fn is_prime(number: u32) -> bool {
    number >= 2
        && (2..)
            .take_while(|divisor| divisor * divisor <= number)
            .all(|divisor| !number.is_multiple_of(divisor))
}

#[inline]
pub(super) fn next_1d(sampler: &Sampler) -> f32 {
    let columns = column_count(sampler.sets.columns);
    let array = Array::new(sampler, sampler.dimension / columns);
    array.value(sampler.dimension % columns, unit_float((sampler.jitter() >> 32) as u32))
}

#[inline]
pub(super) fn next_2d(sampler: &mut Sampler) -> Vec2 {
    let columns = column_count(sampler.sets.columns);
    // A pair has to lie in one array.
    if sampler.dimension % columns == columns - 1 {
        sampler.dimension = sampler.dimension.wrapping_add(1);
    }
    let array = Array::new(sampler, sampler.dimension / columns);
    let column = sampler.dimension % columns;
    let jitter = sampler.jitter();
    Vec2::new(
        array.value(column, unit_float((jitter >> 32) as u32)),
        array.value(column + 1, unit_float(jitter as u32)),
    )
}

/// The columns used of Bose's p + 1: an even number, as columns have partners.
#[inline]
fn column_count(prime: u32) -> u32 {
    (prime + 1) & !1
}

/// One run (row) of one array.
struct Array {
    prime: u32,
    /// The run's two digits to the base p.
    digits: (u32, u32),
    seed: u64,
}

impl Array {
    #[inline]
    fn new(sampler: &Sampler, group: u32) -> Self {
        let prime = sampler.sets.columns;
        let seed = mix64(sampler.set_seed ^ u64::from(group).wrapping_mul(GOLDEN));
        let run = permute(sampler.index, sampler.sets.count, seed as u32);
        Self { prime, digits: (run / prime, run % prime), seed }
    }

    /// The entry of Bose's array: any two columns take every pair of values exactly once.
    #[inline]
    fn entry(&self, column: u32) -> u32 {
        let (high, low) = self.digits;
        match column {
            0 => high,
            1 => low,
            _ => (high + (column - 1) * low) % self.prime,
        }
    }

    /// The coordinate: the entry picks the stratum, the partner column's entry the stratum inside.
    #[inline]
    fn value(&self, column: u32, offset: f32) -> f32 {
        let seed = mix64(self.seed.wrapping_add(u64::from(column + 1).wrapping_mul(GOLDEN)));
        let entry = self.entry(column);
        let stratum = permute(entry, self.prime, seed as u32);
        let inner_seed = mix32((seed >> 32) as u32 ^ entry);
        let inner = permute(self.entry(column ^ 1), self.prime, inner_seed);
        in_stratum(stratum * self.prime + inner, offset, self.prime * self.prime)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_the_next_primes() {
        let sides = [1, 4, 5, 9, 10, 26, 100, 1 << 30].map(|planned| grid(planned).0);
        assert_eq!(sides, [2, 2, 3, 3, 5, 7, 11, 32_771]);
    }
}
