//! Eight lanes as an array: runs on every machine, and is the reference for the other tiers.

use super::{COMPRESSED_LANES, Simd};
use crate::node::{F32x8, WIDTH};

/// The portable tier.
pub(crate) struct Portable;

#[inline(always)]
fn map(a: [f32; WIDTH], b: [f32; WIDTH], operation: impl Fn(f32, f32) -> f32) -> [f32; WIDTH] {
    std::array::from_fn(|lane| operation(a[lane], b[lane]))
}

#[inline(always)]
fn bits(condition: impl Fn(usize) -> bool) -> u32 {
    (0..WIDTH).fold(0, |mask, lane| mask | u32::from(condition(lane)) << lane)
}

impl Simd for Portable {
    type Vector = [f32; WIDTH];
    type Mask = u32;

    #[inline(always)]
    fn splat(value: f32) -> Self::Vector {
        [value; WIDTH]
    }

    #[inline(always)]
    fn load(lanes: &F32x8) -> Self::Vector {
        lanes.0
    }

    #[inline(always)]
    fn store(vector: Self::Vector) -> F32x8 {
        F32x8(vector)
    }

    #[inline(always)]
    fn add(a: Self::Vector, b: Self::Vector) -> Self::Vector {
        map(a, b, |a, b| a + b)
    }

    #[inline(always)]
    fn subtract(a: Self::Vector, b: Self::Vector) -> Self::Vector {
        map(a, b, |a, b| a - b)
    }

    #[inline(always)]
    fn multiply(a: Self::Vector, b: Self::Vector) -> Self::Vector {
        map(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn divide(a: Self::Vector, b: Self::Vector) -> Self::Vector {
        map(a, b, |a, b| a / b)
    }

    #[inline(always)]
    fn multiply_add(a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector {
        // Not `f32::mul_add`, which is a library call on machines without the instruction.
        std::array::from_fn(|lane| a[lane] * b[lane] + c[lane])
    }

    #[inline(always)]
    fn min(a: Self::Vector, b: Self::Vector) -> Self::Vector {
        map(a, b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(a: Self::Vector, b: Self::Vector) -> Self::Vector {
        map(a, b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn abs(a: Self::Vector) -> Self::Vector {
        a.map(f32::abs)
    }

    #[inline(always)]
    fn less(a: Self::Vector, b: Self::Vector) -> u32 {
        bits(|lane| a[lane] < b[lane])
    }

    #[inline(always)]
    fn less_equal(a: Self::Vector, b: Self::Vector) -> u32 {
        bits(|lane| a[lane] <= b[lane])
    }

    #[inline(always)]
    fn and(a: u32, b: u32) -> u32 {
        a & b
    }

    #[inline(always)]
    fn and_not(a: u32, b: u32) -> u32 {
        a & !b
    }

    #[inline(always)]
    fn bitmask(mask: u32) -> u32 {
        mask
    }

    #[inline(always)]
    fn select(mask: u32, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        std::array::from_fn(|lane| if mask >> lane & 1 != 0 { a[lane] } else { b[lane] })
    }

    #[inline(always)]
    fn reduce_min(vector: Self::Vector) -> f32 {
        vector
            .into_iter()
            .fold(f32::INFINITY, |least, number| if number < least { number } else { least })
    }

    #[inline(always)]
    unsafe fn compress(words: &[u32; WIDTH], mask: u32, to: *mut u32) {
        let places = &COMPRESSED_LANES[mask as usize & 0xff];
        for (lane, &place) in places.iter().enumerate() {
            // SAFETY: the caller guarantees room for eight words.
            unsafe { to.add(lane).write(words[place as usize & (WIDTH - 1)]) };
        }
    }
}
