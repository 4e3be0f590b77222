//! What a render did: counts, times, and the samples that it left out.

use std::time::Duration;

use crate::source::SampleId;

/// How many defective samples are kept by name: a broken material can make millions.
pub(crate) const KEPT: usize = 8;

/// Why a sample was left out of its pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Defect {
    /// A value is infinite or not a number.
    NonFinite,
    /// Radiance below zero.
    Negative,
}

/// The samples that were left out of the picture: how many, and the first few by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Defects {
    /// Samples with a value that is infinite or not a number.
    pub non_finite: u64,
    /// Samples with negative radiance.
    pub negative: u64,
    /// The first few in the order of [`SampleId`].
    pub first: Vec<DefectiveSample>,
}

/// A sample that was left out, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DefectiveSample {
    /// Its name.
    pub id: SampleId,
    /// What is wrong with it.
    pub defect: Defect,
}

impl Defects {
    /// The number of all samples that were left out.
    pub fn total(&self) -> u64 {
        self.non_finite.saturating_add(self.negative)
    }

    /// Counts one more. The order of calls does not decide which ones are kept by name.
    pub(crate) fn add(&mut self, defect: Defect, id: SampleId) {
        match defect {
            Defect::NonFinite => self.non_finite += 1,
            Defect::Negative => self.negative += 1,
        }
        self.keep(DefectiveSample { id, defect });
    }

    /// Adds the counts and names of another part of the picture.
    pub(crate) fn merge(&mut self, other: &Self) {
        // A file may claim any count.
        self.non_finite = self.non_finite.saturating_add(other.non_finite);
        self.negative = self.negative.saturating_add(other.negative);
        for &sample in &other.first {
            self.keep(sample);
        }
    }

    fn keep(&mut self, sample: DefectiveSample) {
        let place = self.first.partition_point(|known| known.id < sample.id);
        if place < KEPT {
            self.first.insert(place, sample);
            self.first.truncate(KEPT);
        }
    }
}

/// What a render did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Samples taken, those left out included.
    pub samples: u64,
    /// How many samples the pixels have, those left out included.
    pub samples_per_pixel: SamplesPerPixel,
    /// Passes over the picture, the last one perhaps cut short.
    pub passes: u32,
    /// Threads that rendered.
    pub threads: usize,
    /// Wall time from the first ray to the last.
    pub duration: Duration,
    /// Whether it was cancelled before its budget was spent.
    pub cancelled: bool,
    /// The samples that were left out.
    pub defects: Defects,
    /// The paths that ended because they reached a limit of their length
    /// ([`MAX_EDGES`](etendue_integrators::MAX_EDGES),
    /// [`MAX_COLLISIONS`](etendue_integrators::MAX_COLLISIONS)); further light is missing.
    pub truncated_paths: u64,
}

/// How many samples the pixels of a film have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SamplesPerPixel {
    /// The least number of any pixel.
    pub least: u32,
    /// The greatest number of any pixel.
    pub most: u32,
}

impl SamplesPerPixel {
    /// The same number in every pixel.
    pub fn all(count: u32) -> Self {
        Self { least: count, most: count }
    }

    /// Whether all pixels have the same number.
    pub fn is_even(self) -> bool {
        self.least == self.most
    }
}

impl Statistics {
    /// Samples per second of wall time.
    pub fn samples_per_second(&self) -> f64 {
        self.samples as f64 / self.duration.as_secs_f64().max(1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(index: u32) -> SampleId {
        SampleId { index, y: 0, x: 0 }
    }

    #[test]
    fn the_first_defects_are_kept_whatever_the_order() {
        let (mut forward, mut backward) = (Defects::default(), Defects::default());
        for index in 0..100 {
            forward.add(Defect::Negative, id(index));
            backward.add(Defect::Negative, id(99 - index));
        }
        assert_eq!(forward, backward);
        assert_eq!(forward.negative, 100);
        assert_eq!(forward.first.len(), KEPT);
        assert_eq!(forward.first[KEPT - 1].id, id(KEPT as u32 - 1));
    }

    #[test]
    fn merging_parts_is_counting_the_whole() {
        let (mut whole, mut even, mut odd) = <(Defects, Defects, Defects)>::default();
        for index in 0..40 {
            let part = if index % 2 == 0 { &mut even } else { &mut odd };
            part.add(Defect::NonFinite, id(index));
            whole.add(Defect::NonFinite, id(index));
        }
        even.merge(&odd);
        assert_eq!(even, whole);
        assert_eq!(whole.total(), 40);
    }

    #[test]
    fn counts_from_a_made_up_file_do_not_overflow() {
        let claimed = Defects { non_finite: u64::MAX, negative: u64::MAX, first: Vec::new() };
        let mut sum = claimed.clone();
        sum.merge(&claimed);
        assert_eq!((sum.non_finite, sum.total()), (u64::MAX, u64::MAX));
    }
}
