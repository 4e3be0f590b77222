//! Eight lanes in one AVX register.
//!
//! These functions are always inlined into callers that are compiled for AVX2 (the entry points of
//! `traverse`). [`Avx2`] must not be used anywhere else.

use super::{COMPRESSED_LANES, Simd};
use crate::node::F32x8;
use std::arch::x86_64::*;

/// The AVX2 tier.
pub(crate) struct Avx2;

/// Wraps intrinsics whose instructions the tier guarantees.
macro_rules! intrinsics {
    ($body:expr) => {
        // SAFETY: the entry points of `traverse` select this tier only after `Tier::is_available`
        // has detected AVX2 and FMA; references to `F32x8` are valid and aligned to 32 bytes.
        unsafe { $body }
    };
}

impl Simd for Avx2 {
    type Vector = __m256;
    type Mask = __m256;

    #[inline(always)]
    fn splat(value: f32) -> __m256 {
        intrinsics!(_mm256_set1_ps(value))
    }

    #[inline(always)]
    fn load(lanes: &F32x8) -> __m256 {
        intrinsics!(_mm256_load_ps(lanes.0.as_ptr()))
    }

    #[inline(always)]
    fn store(vector: __m256) -> F32x8 {
        let mut lanes = F32x8([0.0; 8]);
        intrinsics!(_mm256_store_ps(lanes.0.as_mut_ptr(), vector));
        lanes
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
    fn less(a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b))
    }

    #[inline(always)]
    fn less_equal(a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b))
    }

    #[inline(always)]
    fn and(a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_and_ps(a, b))
    }

    #[inline(always)]
    fn and_not(a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_andnot_ps(b, a))
    }

    #[inline(always)]
    fn bitmask(mask: __m256) -> u32 {
        intrinsics!(_mm256_movemask_ps(mask) as u32)
    }

    #[inline(always)]
    fn select(mask: __m256, a: __m256, b: __m256) -> __m256 {
        intrinsics!(_mm256_blendv_ps(b, a, mask))
    }

    #[inline(always)]
    fn reduce_min(vector: __m256) -> f32 {
        intrinsics!({
            let [low, high] = [_mm256_castps256_ps128(vector), _mm256_extractf128_ps::<1>(vector)];
            let four = _mm_min_ps(low, high);
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)))
        })
    }

    #[inline(always)]
    unsafe fn compress(words: &[u32; 8], mask: u32, to: *mut u32) {
        let places = COMPRESSED_LANES[mask as usize & 0xff].as_ptr();
        intrinsics!({
            let places = _mm256_cvtepu8_epi32(_mm_loadl_epi64(places.cast()));
            let words = _mm256_loadu_si256(words.as_ptr().cast());
            _mm256_storeu_si256(to.cast(), _mm256_permutevar8x32_epi32(words, places));
        });
    }
}
