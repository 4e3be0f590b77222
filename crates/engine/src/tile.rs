//! A small rectangle of pixels and the sums of its samples. One thread at a time adds to it.

use crate::exact_sums::{ExactSums, SumsMut};
use crate::region::Region;
use crate::source::{Sample, SampleId};
use crate::statistics::{Defect, Defects};
use etendue_math::lanes::{Level, Simd};
use etendue_math::with_lanes;

/// Red, green, blue and alpha; the extra channels follow.
pub(crate) const COLOR_CHANNELS: usize = 4;

/// Red, green and blue have squares.
pub(crate) const SQUARED_CHANNELS: usize = 3;

/// The sums of one rectangle of pixels, row by row.
#[derive(Clone, Debug)]
pub(crate) struct Tile {
    pub(crate) region: Region,
    /// Channels per pixel, alpha included.
    channel_count: usize,
    /// Σ weight·value of every channel, pixel after pixel.
    pub(crate) sums: ExactSums,
    /// Σ (weight·value)² of red, green and blue; empty without variances.
    pub(crate) squares: ExactSums,
    /// Samples in the sums.
    pub(crate) counts: Vec<u32>,
    /// The index of every pixel's next sample.
    pub(crate) next_sample: u32,
    pub(crate) defects: Defects,
}

/// What the tiles of a film have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileKind {
    /// Channels beyond red, green, blue and alpha.
    pub(crate) extra_channel_count: usize,
    /// Whether squares are summed.
    pub(crate) variance: bool,
    /// Whether samples have splats, which belong to the film as a whole.
    pub(crate) splats: bool,
    /// The index of every pixel's first sample.
    pub(crate) first_sample: u32,
}

impl TileKind {
    /// How many sums a pixel has, of values and of squares.
    pub(crate) fn sums_per_pixel(self) -> u64 {
        let squared = if self.variance { SQUARED_CHANNELS } else { 0 };
        (COLOR_CHANNELS + self.extra_channel_count + squared) as u64
    }
}

impl Tile {
    pub(crate) fn new(region: Region, kind: TileKind) -> Self {
        let pixel_count = region.pixel_count() as usize;
        let channel_count = COLOR_CHANNELS + kind.extra_channel_count;
        let squared = if kind.variance { pixel_count * SQUARED_CHANNELS } else { 0 };
        Self {
            region,
            channel_count,
            sums: ExactSums::new(pixel_count * channel_count),
            squares: ExactSums::new(squared),
            counts: vec![0; pixel_count],
            next_sample: kind.first_sample,
            defects: Defects::default(),
        }
    }

    /// Adds the samples of one pixel of another tile to one of this one.
    pub(crate) fn merge_pixel(&mut self, pixel: usize, other: &Self, other_pixel: usize) {
        self.counts[pixel] = self.counts[pixel].saturating_add(other.counts[other_pixel]);
        let merge = |sums: &mut ExactSums, others: &ExactSums, count: usize| {
            for channel in 0..count {
                let raw = others.raw(other_pixel * count + channel);
                sums.merge_one(pixel * count + channel, raw);
            }
        };
        merge(&mut self.sums, &other.sums, self.channel_count);
        if !self.squares.is_empty() {
            merge(&mut self.squares, &other.squares, SQUARED_CHANNELS);
        }
    }

    /// The mean of a channel of a pixel; zero without samples.
    pub(crate) fn mean(&self, pixel: usize, channel: usize) -> f64 {
        match self.counts[pixel] {
            0 => 0.0,
            count => self.sum(pixel, channel) / f64::from(count),
        }
    }

    /// The variance of the mean of red, green or blue: the unbiased estimate
    /// (Σv² − (Σv)²/n) / (n − 1) of a sample's, over n. With fewer than two samples, or without
    /// squares, the variance is unknown and this returns zero.
    pub(crate) fn variance_of_mean(&self, pixel: usize, channel: usize) -> f64 {
        if self.counts[pixel] < 2 || self.squares.is_empty() {
            return 0.0;
        }
        let count = f64::from(self.counts[pixel]);
        let sum = self.sum(pixel, channel);
        let square = self.squares.value(pixel * SQUARED_CHANNELS + channel);
        // Rounding can make the difference slightly negative.
        (square - sum * sum / count).max(0.0) / (count - 1.0) / count
    }

    fn sum(&self, pixel: usize, channel: usize) -> f64 {
        self.sums.value(pixel * self.channel_count + channel)
    }

    /// Adds samples to their pixels. `channels` has the extra channels of all samples, one after the
    /// other.
    pub(crate) fn add(&mut self, ids: &[SampleId], samples: &[Sample], channels: &[f32]) {
        with_lanes!(Level::new(), simd => self.add_all(simd, ids, samples, channels));
    }

    #[inline(always)]
    fn add_all<V: Simd>(
        &mut self,
        simd: V,
        ids: &[SampleId],
        samples: &[Sample],
        channels: &[f32],
    ) {
        let extra_channel_count = self.channel_count - COLOR_CHANNELS;
        // By reference: copied out one by one, ids of twelve bytes would be read back in pieces that
        // the processor cannot forward, which takes half of the time of this loop.
        for (index, (id, sample)) in ids.iter().zip(samples).enumerate() {
            let channels =
                &channels[index * extra_channel_count..(index + 1) * extra_channel_count];
            self.add_one(simd, *id, sample, channels);
        }
    }

    #[inline(always)]
    fn add_one<V: Simd>(&mut self, simd: V, id: SampleId, sample: &Sample, channels: &[f32]) {
        if let Some(defect) = find_defect(sample, channels) {
            self.defects.add(defect, id);
            return;
        }
        let row = (id.y - self.region.y) as usize;
        let pixel = row * self.region.width as usize + (id.x - self.region.x) as usize;
        self.counts[pixel] += 1;
        let place = pixel * self.channel_count;
        add(simd, &mut self.sums.slice_mut(place, self.channel_count), sample, channels);
        if !self.squares.is_empty() {
            let place = pixel * SQUARED_CHANNELS;
            add_squares(&mut self.squares.slice_mut(place, SQUARED_CHANNELS), sample);
        }
    }
}

/// Why a sample must be left out of the picture, if it must. Only light may not be negative:
/// channels such as positions may, and so may the filter's weight.
#[inline]
fn find_defect(sample: &Sample, channels: &[f32]) -> Option<Defect> {
    let finite = sample.color.is_finite() && sample.alpha.is_finite();
    if !finite || channels.iter().any(|value| !value.is_finite()) {
        Some(Defect::NonFinite)
    } else if sample.color.has_negative() {
        Some(Defect::Negative)
    } else {
        None
    }
}

#[inline(always)]
fn add<V: Simd>(simd: V, sums: &mut SumsMut<'_>, sample: &Sample, channels: &[f32]) {
    let weight = f64::from(sample.weight);
    let [red, green, blue] = sample.color.rgb();
    let values: [f32; COLOR_CHANNELS] = [red, green, blue, sample.alpha];
    sums.add_four(simd, 0, values.map(|value| weight * f64::from(value)));
    for (index, &value) in channels.iter().enumerate() {
        sums.add(COLOR_CHANNELS + index, weight * f64::from(value));
    }
}

#[inline(always)]
fn add_squares(squares: &mut SumsMut<'_>, sample: &Sample) {
    let weight = f64::from(sample.weight);
    for (channel, value) in sample.color.rgb().into_iter().enumerate() {
        let weighted = weight * f64::from(value);
        squares.add(channel, weighted * weighted);
    }
}
