//! Packets of eight rays in one AVX register.
//!
//! These functions are always inlined into callers that are compiled for AVX2 (the entry points of
//! `traverse`). `Wide` must not be used with [`Avx2`] anywhere else.

use super::avx2::Avx2;
use super::wide::{MAX_LANES, Row, Wide};
use crate::node::{F32x8, WIDTH};
use std::arch::x86_64::*;

/// Wraps intrinsics whose instructions the tier guarantees.
macro_rules! intrinsics {
    ($body:expr) => {
        // SAFETY: the entry points of `traverse` select this tier only after `Tier::is_available`
        // has detected AVX2 and FMA; references to `Row` are valid and aligned to 64 bytes.
        unsafe { $body }
    };
}

/// A vector whose lanes in the set have all bits set.
#[inline(always)]
fn mask(lanes: u32) -> __m256 {
    intrinsics!({
        let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        let set = _mm256_and_si256(_mm256_set1_epi32(lanes as i32), bits);
        _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bits))
    })
}

impl Wide for Avx2 {
    const LANES: usize = WIDTH;
    type Vector = __m256;
    /// The lanes on y, and those on z.
    type Axes = (__m256, __m256);
    type Vertex<'a> = &'a [F32x8; 3];

    #[inline(always)]
    fn splat(value: f32) -> __m256 {
        intrinsics!(_mm256_set1_ps(value))
    }

    #[inline(always)]
    fn load(row: &Row) -> __m256 {
        intrinsics!(_mm256_load_ps(row.0.as_ptr()))
    }

    #[inline(always)]
    fn store(vector: __m256) -> Row {
        let mut row = Row([0.0; MAX_LANES]);
        intrinsics!(_mm256_store_ps(row.0.as_mut_ptr(), vector));
        row
    }

    #[inline(always)]
    fn add(a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_add_ps(a, b))
    }

    #[inline(always)]
    fn subtract(a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_sub_ps(a, b))
    }

    #[inline(always)]
    fn multiply(a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_mul_ps(a, b))
    }

    #[inline(always)]
    fn divide(a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_div_ps(a, b))
    }

    #[inline(always)]
    fn multiply_add(a: __m256, b: __m256, c: __m256) -> __m256 {
        intrinsics!(_mm256_fmadd_ps(a, b, c))
    }

    #[inline(always)]
    fn min(a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_min_ps(a, b))
    }

    #[inline(always)]
    fn max(a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_max_ps(a, b))
    }

    #[inline(always)]
    fn abs(a: __m256) -> __m256 {
        intrinsics!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), a))
    }

    #[inline(always)]
    fn copysign(magnitude: __m256, sign: __m256) -> __m256 {
        intrinsics!({
            let bit = _mm256_set1_ps(-0.0);
            _mm256_or_ps(_mm256_andnot_ps(bit, magnitude), _mm256_and_ps(bit, sign))
        })
    }

    #[inline(always)]
    fn step_down(a: __m256) -> __m256 {
        intrinsics!({
            let one = _mm256_set1_epi32(1);
            _mm256_castsi256_ps(_mm256_sub_epi32(_mm256_castps_si256(a), one))
        })
    }

    #[inline(always)]
    fn less(a: __m256, b: __m256) -> u32 {
        intrinsics!(_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b)) as u32)
    }

    #[inline(always)]
    fn less_equal(a: __m256, b: __m256) -> u32 {
        intrinsics!(_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32)
    }

    #[inline(always)]
    fn select(lanes: u32, yes: __m256, no: __m256) -> __m256 {
        intrinsics!(_mm256_blendv_ps(no, yes, mask(lanes)))
    }

    #[inline(always)]
    fn set_words(row: &mut Row<u32>, lanes: u32, word: u32) {
        intrinsics!({
            let place = row.0.as_mut_ptr().cast();
            let new = _mm256_castsi256_ps(_mm256_set1_epi32(word as i32));
            _mm256_store_ps(place, _mm256_blendv_ps(_mm256_load_ps(place), new, mask(lanes)));
        });
    }

    #[inline(always)]
    fn axes(y: u32, z: u32) -> Self::Axes {
        (mask(y), mask(z))
    }

    #[inline(always)]
    fn vertex(coordinates: &[F32x8; 3]) -> Self::Vertex<'_> {
        coordinates
    }

    #[inline(always)]
    fn coordinate(vertex: &[F32x8; 3], triangle: usize, (on_y, on_z): Self::Axes) -> __m256 {
        let [x, y, z] = vertex;
        let lane = triangle & (WIDTH - 1);
        intrinsics!({
            let (x, y) = (_mm256_broadcast_ss(&x.0[lane]), _mm256_broadcast_ss(&y.0[lane]));
            let x_or_y = _mm256_blendv_ps(x, y, on_y);
            _mm256_blendv_ps(x_or_y, _mm256_broadcast_ss(&z.0[lane]), on_z)
        })
    }
}
