//! What a render did: counts, times, and the samples that had to be left out.

use std::time::Duration;

use crate::SampleId;

/// How many defective samples keep their names; a broken material can make millions.
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
    pub first: Vec<(SampleId, Defect)>,
}

impl Defects {
    /// All samples that were left out.
    pub fn total(&self) -> u64 {
        self.non_finite.saturating_add(self.negative)
    }

    /// Counts one more. Which ones are kept by name does not depend on the order of calls.
    pub(crate) fn add(&mut self, defect: Defect, id: SampleId) {
        match defect {
            Defect::NonFinite => self.non_finite += 1,
            Defect::Negative => self.negative += 1,
        }
        self.keep(id, defect);
    }

    /// Adds the counts and names of another part of the picture.
    pub(crate) fn merge(&mut self, other: &Self) {
        // A file may claim any number of defects.
        self.non_finite = self.non_finite.saturating_add(other.non_finite);
        self.negative = self.negative.saturating_add(other.negative);
        for &(id, defect) in &other.first {
            self.keep(id, defect);
        }
    }

    fn keep(&mut self, id: SampleId, defect: Defect) {
        let place = self.first.partition_point(|&(known, _)| known < id);
        if place < KEPT {
            self.first.insert(place, (id, defect));
            self.first.truncate(KEPT);
        }
    }
}

/// What a render did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Samples taken, those left out included.
    pub samples: u64,
    /// The least and the greatest number of samples any pixel got, those left out included.
    pub samples_per_pixel: [u32; 2],
    /// Passes over the picture that were begun.
    pub passes: u32,
    /// Threads that rendered.
    pub threads: usize,
    /// From the first ray to the last, by the wall clock.
    pub duration: Duration,
    /// Whether it was cancelled before its budget was spent.
    pub cancelled: bool,
    /// The samples that were left out.
    pub defects: Defects,
}

impl Statistics {
    /// Samples per second of the wall clock.
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
        assert_eq!(forward.first[KEPT - 1].0, id(KEPT as u32 - 1));
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
