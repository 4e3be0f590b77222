//! The innermost steps of the binned build, by the instructions that the machine has. The results
//! do not depend on them.

use super::binned::{Box4, MAX_BINS};
use super::reference::Reference;
use glam::{BVec4A, Vec4};

/// What is done for every reference on every level of the tree.
pub(super) trait Kernel {
    /// Grows one bin of each axis by a reference's box.
    fn add(bins: &mut [[Box4; MAX_BINS]; 3], places: [usize; 3], reference: &Reference);
    /// Boxes of centres on the left side and on the right side, in registers.
    type Sides: Copy;
    /// No centres yet.
    fn no_centers() -> Self::Sides;
    /// Grows the box of one side by a centre.
    fn grow_side(sides: Self::Sides, center: Vec4, is_left: bool) -> Self::Sides;
    /// The boxes.
    fn boxes(sides: Self::Sides) -> [Box4; 2];
}

/// What every machine has.
pub(super) struct Portable;

impl Kernel for Portable {
    #[inline(always)]
    fn add(bins: &mut [[Box4; MAX_BINS]; 3], places: [usize; 3], reference: &Reference) {
        let grown = Box4::of(reference);
        for (bins, place) in bins.iter_mut().zip(places) {
            bins[place].grow(&grown);
        }
    }

    type Sides = [Box4; 2];

    #[inline(always)]
    fn no_centers() -> [Box4; 2] {
        [Box4::EMPTY; 2]
    }

    #[inline(always)]
    fn grow_side([mut left, mut right]: [Box4; 2], center: Vec4, is_left: bool) -> [Box4; 2] {
        let mask = BVec4A::splat(is_left);
        let nothing = Box4::EMPTY.min;
        left.grow(&Box4 {
            min: Vec4::select(mask, center, nothing),
            negated_max: Vec4::select(mask, -center, nothing),
        });
        right.grow(&Box4 {
            min: Vec4::select(mask, nothing, center),
            negated_max: Vec4::select(mask, nothing, -center),
        });
        [left, right]
    }

    #[inline(always)]
    fn boxes(sides: [Box4; 2]) -> [Box4; 2] {
        sides
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::Avx2;

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{Box4, Kernel, MAX_BINS, Reference};
    use glam::Vec4;
    use std::arch::x86_64::*;

    /// Both corners of a box in one register. Its functions are always inlined into
    /// `Builder::split_avx2`, the only place that names it.
    pub(in super::super) struct Avx2;

    /// Negates the upper half, where greatest corners are.
    #[inline(always)]
    fn upper_signs() -> __m256 {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_setr_ps(0.0, 0.0, 0.0, 0.0, -0.0, -0.0, -0.0, -0.0) }
    }

    impl Kernel for Avx2 {
        #[inline(always)]
        fn add(bins: &mut [[Box4; MAX_BINS]; 3], places: [usize; 3], reference: &Reference) {
            // SAFETY: see `Avx2`; references and boxes are eight aligned floats.
            unsafe {
                let both = _mm256_load_ps((&raw const *reference).cast());
                let grown = _mm256_xor_ps(both, upper_signs());
                for (bins, place) in bins.iter_mut().zip(places) {
                    let bin: *mut f32 = (&raw mut bins[place]).cast();
                    _mm256_store_ps(bin, _mm256_min_ps(grown, _mm256_load_ps(bin)));
                }
            }
        }

        type Sides = [__m256; 2];

        #[inline(always)]
        fn no_centers() -> [__m256; 2] {
            // SAFETY: see `Avx2`.
            unsafe { [_mm256_set1_ps(f32::INFINITY); 2] }
        }

        #[inline(always)]
        fn grow_side([left, right]: [__m256; 2], center: Vec4, is_left: bool) -> [__m256; 2] {
            // SAFETY: see `Avx2`.
            unsafe {
                let center = _mm256_broadcast_ps(&center.into());
                let grown = _mm256_xor_ps(center, upper_signs());
                let mask = _mm256_castsi256_ps(_mm256_set1_epi32(-i32::from(is_left)));
                let nothing = _mm256_set1_ps(f32::INFINITY);
                [
                    _mm256_min_ps(_mm256_blendv_ps(nothing, grown, mask), left),
                    _mm256_min_ps(_mm256_blendv_ps(grown, nothing, mask), right),
                ]
            }
        }

        #[inline(always)]
        fn boxes(sides: [__m256; 2]) -> [Box4; 2] {
            let mut boxes = [Box4::EMPTY; 2];
            for (into, side) in boxes.iter_mut().zip(sides) {
                // SAFETY: see `Avx2`; a box is eight aligned floats.
                unsafe { _mm256_store_ps((&raw mut *into).cast(), side) };
            }
            boxes
        }
    }
}
