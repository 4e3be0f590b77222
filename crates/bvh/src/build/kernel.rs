//! The innermost loops of the binned build, with one implementation per instruction set. The
//! results do not depend on it.

use super::bins::{Binning, Bins, Plane};
use super::extent::Box4;
use super::reference::Reference;

/// The operations on every reference at every level of the tree.
pub(super) trait Kernel {
    /// Adds references to the bins.
    fn add(bins: &mut Bins, binning: &Binning, references: &[Reference]);

    /// Moves the references left of the plane to the front. Returns their number, and the boxes of
    /// the centres on both sides.
    ///
    /// Without a branch on the side, which is unpredictable: a reference of the right side is
    /// swapped with another of that side, and the box of the other side's centres grows by an empty
    /// box. This made the build a third faster.
    fn partition(references: &mut [Reference], plane: &Plane) -> (usize, [Box4; 2]);
}

/// Runs on every machine.
pub(super) struct Portable;

impl Kernel for Portable {
    #[inline(always)]
    fn add(bins: &mut Bins, binning: &Binning, references: &[Reference]) {
        for reference in references {
            let grown = Box4::of(reference);
            for (axis, bin) in binning.bins(reference).into_iter().enumerate() {
                bins.boxes[axis][bin].grow(&grown);
                bins.counts[axis][bin] += 1;
            }
        }
    }

    #[inline(always)]
    fn partition(references: &mut [Reference], plane: &Plane) -> (usize, [Box4; 2]) {
        let mut centers = [Box4::EMPTY; 2];
        let mut left = 0;
        for index in 0..references.len() {
            let reference = references[index];
            let center = reference.center();
            let is_left = plane.binning.place(center)[plane.axis] < plane.limit;
            let point = Box4::of_point(center);
            let grown = if is_left { [point, Box4::EMPTY] } else { [Box4::EMPTY, point] };
            centers.iter_mut().zip(&grown).for_each(|(side, grown)| side.grow(grown));
            references[index] = references[left];
            references[left] = reference;
            left += usize::from(is_left);
        }
        (left, centers)
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::Avx2;

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{Binning, Bins, Box4, Kernel, Plane, Reference};
    use crate::build::bins::MAX_BINS;
    use glam::Vec4;
    use std::arch::x86_64::*;

    /// Both corners of a box in one register. These functions are always inlined into those
    /// functions of `binned` that are compiled for AVX2, the only places that use it. (A closure
    /// would not be inlined.)
    pub(in super::super) struct Avx2;

    /// From this number of references on, two sets of bins are faster.
    const TWO_SETS: usize = 64;

    /// The sign bits of the upper half, which holds the maximum corner.
    #[inline(always)]
    fn upper_signs() -> __m256 {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_setr_ps(0.0, 0.0, 0.0, 0.0, -0.0, -0.0, -0.0, -0.0) }
    }

    /// A reference in one register. The fourth and the eighth component are its ids.
    #[inline(always)]
    fn load(reference: &Reference) -> __m256 {
        // SAFETY: see `Avx2`; a reference has the size and alignment of eight aligned floats.
        unsafe { _mm256_load_ps((&raw const *reference).cast()) }
    }

    /// Both corners of a loaded reference. The other components are zero.
    #[inline(always)]
    fn corners(reference: __m256) -> __m256 {
        // SAFETY: see `Avx2`.
        unsafe {
            let corners = _mm256_setr_epi32(-1, -1, -1, 0, -1, -1, -1, 0);
            _mm256_and_ps(reference, _mm256_castsi256_ps(corners))
        }
    }

    /// As [`Reference::center`].
    #[inline(always)]
    fn center(corners: __m256) -> Vec4 {
        // SAFETY: see `Avx2`.
        unsafe {
            let half = _mm256_mul_ps(corners, _mm256_set1_ps(0.5));
            _mm_add_ps(_mm256_castps256_ps128(half), _mm256_extractf128_ps::<1>(half)).into()
        }
    }

    /// Adds a reference to one bin of each axis.
    #[inline(always)]
    fn add_one(bins: &mut Bins, binning: &Binning, reference: &Reference) {
        let corners = corners(load(reference));
        let place = binning.place(center(corners));
        // SAFETY: see `Avx2`; boxes are eight aligned floats, and masked indices are below
        // `MAX_BINS`.
        unsafe {
            let grown = _mm256_xor_ps(corners, upper_signs());
            let mask = _mm_set1_epi32(MAX_BINS as i32 - 1);
            let place = _mm_and_si128(_mm_castps_si128(place.into()), mask);
            let two = _mm_cvtsi128_si64(place) as usize;
            let places =
                [two & u32::MAX as usize, two >> 32, _mm_extract_epi32::<2>(place) as usize];
            for (axis, bin) in places.into_iter().enumerate() {
                let of_bin: *mut f32 = (&raw mut *bins.boxes[axis].get_unchecked_mut(bin)).cast();
                _mm256_store_ps(of_bin, _mm256_min_ps(grown, _mm256_load_ps(of_bin)));
                *bins.counts[axis].get_unchecked_mut(bin) += 1;
            }
        }
    }

    impl Kernel for Avx2 {
        #[inline(always)]
        fn add(bins: &mut Bins, binning: &Binning, references: &[Reference]) {
            if references.len() < TWO_SETS {
                for reference in references {
                    add_one(bins, binning, reference);
                }
                return;
            }
            // Neighbours often fall into the same bin. Alternating between two sets removes the
            // dependency between them.
            let mut others = bins.new_like();
            let mut pairs = references.chunks_exact(2);
            for pair in &mut pairs {
                add_one(bins, binning, &pair[0]);
                add_one(&mut others, binning, &pair[1]);
            }
            for reference in pairs.remainder() {
                add_one(bins, binning, reference);
            }
            bins.merge(&others);
        }

        #[inline(always)]
        fn partition(references: &mut [Reference], plane: &Plane) -> (usize, [Box4; 2]) {
            let first: *mut f32 = references.as_mut_ptr().cast();
            let mut centers = [Box4::EMPTY; 2];
            let mut left = 0;
            // SAFETY: see `Avx2`; references and boxes are eight aligned floats, and `left` never
            // exceeds `index`.
            unsafe {
                let axis = _mm256_set1_epi32(plane.axis as i32);
                let limit = _mm256_set1_ps(plane.limit);
                let nothing = _mm256_set1_ps(f32::INFINITY);
                let mut sides = [nothing; 2];
                for index in 0..references.len() {
                    let here = first.add(8 * index);
                    let reference = _mm256_load_ps(here);
                    let center = center(corners(reference));
                    let place = _mm256_castps128_ps256(plane.binning.place(center).into());
                    let place = _mm256_permutevar8x32_ps(place, axis);
                    let is_left = _mm256_cmp_ps::<_CMP_LT_OQ>(place, limit);
                    let grown = _mm256_xor_ps(_mm256_broadcast_ps(&center.into()), upper_signs());
                    sides = [
                        _mm256_min_ps(_mm256_blendv_ps(nothing, grown, is_left), sides[0]),
                        _mm256_min_ps(_mm256_blendv_ps(grown, nothing, is_left), sides[1]),
                    ];
                    let there = first.add(8 * left);
                    _mm256_store_ps(here, _mm256_load_ps(there));
                    _mm256_store_ps(there, reference);
                    left += _mm256_movemask_ps(is_left) as usize & 1;
                }
                for (into, side) in centers.iter_mut().zip(sides) {
                    _mm256_store_ps((&raw mut *into).cast(), side);
                }
            }
            (left, centers)
        }
    }
}
