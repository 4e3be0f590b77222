//! Packets of sixteen rays in one AVX-512 register.
//!
//! These functions are always inlined into callers that are compiled for AVX-512 (the entry points
//! of `traverse`). [`Avx512`] must not be used anywhere else.

use super::wide::{MAX_LANES, Row, Wide};
use crate::node::{F32x8, WIDTH};
use std::arch::x86_64::*;

/// The packets of the AVX-512 tier.
pub(crate) struct Avx512;

/// Wraps intrinsics whose instructions the tier guarantees.
macro_rules! intrinsics {
    ($body:expr) => {
        // SAFETY: the entry points of `traverse` select this tier only after `Tier::is_available`
        // has detected AVX-512 F, VL, DQ and BW; references to `Row` are valid and aligned to 64
        // bytes.
        unsafe { $body }
    };
}

impl Wide for Avx512 {
    const LANES: usize = MAX_LANES;
    type Vector = __m512;
    /// The axis of each lane, times [`WIDTH`].
    type Axes = __m512i;
    /// x and y, then z.
    type Vertex<'a> = (__m512, __m512);

    #[inline(always)]
    fn splat(value: f32) -> __m512 {
        intrinsics!(_mm512_set1_ps(value))
    }

    #[inline(always)]
    fn load(row: &Row) -> __m512 {
        intrinsics!(_mm512_load_ps(row.0.as_ptr()))
    }

    #[inline(always)]
    fn store(vector: __m512) -> Row {
        let mut row = Row([0.0; MAX_LANES]);
        intrinsics!(_mm512_store_ps(row.0.as_mut_ptr(), vector));
        row
    }

    #[inline(always)]
    fn add(a: __m512, b: __m512) -> __m512 {
        intrinsics!(_mm512_add_ps(a, b))
    }

    #[inline(always)]
    fn subtract(a: __m512, b: __m512) -> __m512 {
        intrinsics!(_mm512_sub_ps(a, b))
    }

    #[inline(always)]
    fn multiply(a: __m512, b: __m512) -> __m512 {
        intrinsics!(_mm512_mul_ps(a, b))
    }

    #[inline(always)]
    fn divide(a: __m512, b: __m512) -> __m512 {
        intrinsics!(_mm512_div_ps(a, b))
    }

    #[inline(always)]
    fn multiply_add(a: __m512, b: __m512, c: __m512) -> __m512 {
        intrinsics!(_mm512_fmadd_ps(a, b, c))
    }

    #[inline(always)]
    fn min(a: __m512, b: __m512) -> __m512 {
        intrinsics!(_mm512_min_ps(a, b))
    }

    #[inline(always)]
    fn max(a: __m512, b: __m512) -> __m512 {
        intrinsics!(_mm512_max_ps(a, b))
    }

    #[inline(always)]
    fn abs(a: __m512) -> __m512 {
        intrinsics!(_mm512_andnot_ps(_mm512_set1_ps(-0.0), a))
    }

    #[inline(always)]
    fn copysign(magnitude: __m512, sign: __m512) -> __m512 {
        intrinsics!({
            let bit = _mm512_set1_ps(-0.0);
            _mm512_or_ps(_mm512_andnot_ps(bit, magnitude), _mm512_and_ps(bit, sign))
        })
    }

    #[inline(always)]
    fn step_down(a: __m512) -> __m512 {
        intrinsics!({
            let one = _mm512_set1_epi32(1);
            _mm512_castsi512_ps(_mm512_sub_epi32(_mm512_castps_si512(a), one))
        })
    }

    #[inline(always)]
    fn less(a: __m512, b: __m512) -> u32 {
        intrinsics!(u32::from(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b)))
    }

    #[inline(always)]
    fn less_equal(a: __m512, b: __m512) -> u32 {
        intrinsics!(u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b)))
    }

    #[inline(always)]
    fn select(lanes: u32, yes: __m512, no: __m512) -> __m512 {
        intrinsics!(_mm512_mask_blend_ps(lanes as u16, no, yes))
    }

    #[inline(always)]
    fn set_words(row: &mut Row<u32>, lanes: u32, word: u32) {
        intrinsics!({
            // Not a masked store: the next load would have to wait for it.
            let words = _mm512_load_si512(row.0.as_ptr().cast());
            let words = _mm512_mask_set1_epi32(words, lanes as u16, word as i32);
            _mm512_store_si512(row.0.as_mut_ptr().cast(), words);
        });
    }

    #[inline(always)]
    fn axes(y: u32, z: u32) -> __m512i {
        intrinsics!({
            let axes = _mm512_maskz_set1_epi32(y as u16, WIDTH as i32);
            _mm512_mask_set1_epi32(axes, z as u16, 2 * WIDTH as i32)
        })
    }

    #[inline(always)]
    fn vertex(coordinates: &[F32x8; 3]) -> Self::Vertex<'_> {
        intrinsics!((
            _mm512_loadu_ps(coordinates[0].0.as_ptr().cast()),
            _mm512_castps256_ps512(_mm256_load_ps(coordinates[2].0.as_ptr())),
        ))
    }

    #[inline(always)]
    fn coordinate((xy, z): Self::Vertex<'_>, triangle: usize, axes: __m512i) -> __m512 {
        intrinsics!({
            let places = _mm512_add_epi32(axes, _mm512_set1_epi32(triangle as i32));
            _mm512_permutex2var_ps(xy, places, z)
        })
    }
}
