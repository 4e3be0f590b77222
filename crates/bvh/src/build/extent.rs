//! Bounding boxes in SIMD registers.

use super::reference::Reference;
use glam::Vec4;
use rayon::prelude::*;

/// A box in SIMD registers. The maximum corner is negated, so that both corners grow by a minimum.
/// The fourth components are never denormal; else they are unspecified.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Box4 {
    pub(super) min: Vec4,
    pub(super) negated_max: Vec4,
}

impl Box4 {
    pub(super) const EMPTY: Self =
        Self { min: Vec4::splat(f32::INFINITY), negated_max: Vec4::splat(f32::INFINITY) };

    #[inline(always)]
    pub(super) fn of(reference: &Reference) -> Self {
        let [min, max] = reference.corners();
        Self { min, negated_max: -max }
    }

    #[inline(always)]
    pub(super) fn of_point(point: Vec4) -> Self {
        Self { min: point, negated_max: -point }
    }

    #[inline(always)]
    pub(super) fn grow(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.negated_max = self.negated_max.min(other.negated_max);
    }

    /// The lengths of the sides.
    #[inline(always)]
    pub(super) fn extent(&self) -> Vec4 {
        -(self.negated_max + self.min)
    }

    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        // Both extents are negated; the signs cancel in the products.
        let extent = self.negated_max + self.min;
        extent.x * (extent.y + extent.z) + extent.y * extent.z
    }
}

/// The boxes around a range of references and around their centres.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub(super) bounds: Box4,
    pub(super) centers: Box4,
}

impl Extent {
    const EMPTY: Self = Self { bounds: Box4::EMPTY, centers: Box4::EMPTY };

    #[inline(always)]
    fn add(&mut self, reference: &Reference) {
        self.bounds.grow(&Box4::of(reference));
        self.centers.grow(&Box4::of_point(reference.center()));
    }

    pub(super) fn of(references: &[Reference]) -> Self {
        let mut extent = Self::EMPTY;
        references.iter().for_each(|reference| extent.add(reference));
        extent
    }

    /// As [`Extent::of`], in parallel.
    pub(super) fn of_many(references: &[Reference]) -> Self {
        let chunks: Vec<Self> = references.par_chunks(Reference::CHUNK).map(Self::of).collect();
        let mut extent = Self::EMPTY;
        for chunk in &chunks {
            extent.bounds.grow(&chunk.bounds);
            extent.centers.grow(&chunk.centers);
        }
        extent
    }
}
