//! Table lookups.

use super::float::{LaneArray, Lanes};
use super::level::MAX_LANES;
use super::real::Real;
use fearless_simd::{Bytes as _, Simd, prelude::*};

/// The number of entries in a table.
pub const TABLE_ENTRIES: usize = 64;

/// The low bits of 2²³ + n are those of the integer n.
const TWO_TO_23: f32 = 8_388_608.0;

impl<S: Simd> Lanes<S> {
    /// Looks up each lane's index, an integer from 0 to 63, in one table.
    #[inline(always)]
    #[must_use]
    pub fn of_table(simd: S, table: &[f32; TABLE_ENTRIES], index: Self) -> Self {
        if Self::COUNT < MAX_LANES {
            return Self::of_tables(simd, index, |_| table);
        }
        // Four registers hold the whole table. Permute bytes, four per entry.
        let quarter = |number: usize| {
            let first = number * MAX_LANES;
            S::f32s::from_slice(simd, &table[first..first + MAX_LANES])
        };
        let index_bits = (index + TWO_TO_23).bits() & (TABLE_ENTRIES as u32 - 1);
        let bytes = index_bits * 0x0404_0404 + 0x0302_0100;
        let bytes: S::u8s = bytes.to_bytes();
        let low = quarter(0).concat_swizzle_dyn(quarter(1), bytes & 127);
        let high = quarter(2).concat_swizzle_dyn(quarter(3), bytes & 127);
        Self::select(index.below(32.0), Self(low), Self(high))
    }

    /// Looks up each lane's index in a table of its own.
    #[inline(always)]
    #[must_use]
    pub fn of_tables<'a>(
        simd: S,
        index: Self,
        table: impl Fn(usize) -> &'a [f32; TABLE_ENTRIES],
    ) -> Self {
        let shifted = index + TWO_TO_23;
        let mut entries = LaneArray::ZERO;
        for lane in 0..Self::COUNT {
            let index = shifted.lane(lane).to_bits() as usize % TABLE_ENTRIES;
            entries.0[lane] = table(lane)[index];
        }
        Self::load(simd, &entries, 0)
    }
}
