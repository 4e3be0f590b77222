//! A small rectangle of pixels and the sums of its samples: what one thread works on at a time.

use crate::SampleId;
use crate::exact_sums::{ExactSums, SumsMut};
use crate::region::Region;
use crate::source::{Sample, SampleSource};
use crate::splats::Splats;
use crate::statistics::{Defect, Defects};
use etendue_math::lanes::{Level, Simd};
use etendue_math::with_lanes;

/// Red, green, blue and alpha; the extra channels follow.
pub(crate) const COLOR_CHANNELS: usize = 4;

/// Red, green and blue have squares.
pub(crate) const SQUARED_CHANNELS: usize = 3;

/// The sums of one rectangle of pixels, row by row.
#[derive(Debug)]
pub(crate) struct Tile {
    pub(crate) region: Region,
    /// Channels per pixel, alpha included.
    channel_count: usize,
    /// Σ weight·value of every channel, pixel after pixel.
    pub(crate) sums: ExactSums,
    /// Σ (weight·value)² of red, green and blue; empty if nobody asks for variances.
    pub(crate) squares: ExactSums,
    /// Samples in the sums.
    pub(crate) counts: Vec<u32>,
    /// The sample index that every pixel's next sample has.
    pub(crate) next_sample: u32,
    pub(crate) defects: Defects,
}

/// What the tiles of a film have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileKind {
    /// Channels beyond red, green, blue and alpha.
    pub(crate) extra_count: usize,
    /// Whether squares are summed.
    pub(crate) variance: bool,
    /// Whether samples leave splats, too, which belong to the film as a whole.
    pub(crate) splats: bool,
    /// The index of every pixel's first sample.
    pub(crate) first_sample: u32,
}

impl TileKind {
    /// Sums of values and of squares.
    pub(crate) fn sums_per_pixel(self) -> u64 {
        let squared = if self.variance { SQUARED_CHANNELS } else { 0 };
        (COLOR_CHANNELS + self.extra_count + squared) as u64
    }
}

impl Tile {
    pub(crate) fn new(region: Region, kind: TileKind) -> Self {
        let pixel_count = region.pixel_count() as usize;
        let channel_count = COLOR_CHANNELS + kind.extra_count;
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
    /// squares, nothing is known, which is said as zero.
    pub(crate) fn variance_of_mean(&self, pixel: usize, channel: usize) -> f64 {
        if self.counts[pixel] < 2 || self.squares.is_empty() {
            return 0.0;
        }
        let count = f64::from(self.counts[pixel]);
        let sum = self.sum(pixel, channel);
        let square = self.squares.value(pixel * SQUARED_CHANNELS + channel);
        // Rounding can leave a constant pixel a hair below zero.
        (square - sum * sum / count).max(0.0) / (count - 1.0) / count
    }

    fn sum(&self, pixel: usize, channel: usize) -> f64 {
        self.sums.value(pixel * self.channel_count + channel)
    }

    /// Gives every pixel its samples up to, but not with, index `end`; returns how many were taken.
    /// Splats go to `splats`.
    pub(crate) fn render<S: SampleSource>(
        &mut self,
        source: &S,
        end: u32,
        splats: Option<&Splats>,
    ) -> u64 {
        let Region { x, y, width, height } = self.region;
        let count = end.saturating_sub(self.next_sample);
        let mut batch = Batch::new(source.channels().len());
        for row in 0..if count > 0 { height } else { 0 } {
            for column in 0..width {
                if let Some(splats) = splats {
                    self.render_splats(source, [x + column, y + row], end, splats);
                }
                for index in self.next_sample..end {
                    batch.ids.push(SampleId { index, x: x + column, y: y + row });
                    if batch.ids.len() == BATCH_SIZE {
                        self.take(source, &mut batch);
                    }
                }
            }
        }
        self.take(source, &mut batch);
        self.next_sample += count;
        self.region.pixel_count() * u64::from(count)
    }

    fn render_splats<S: SampleSource>(
        &mut self,
        source: &S,
        [x, y]: [u32; 2],
        end: u32,
        splats: &Splats,
    ) {
        let Some(splat_source) = source.splats() else { return };
        for index in self.next_sample..end {
            let id = SampleId { index, y, x };
            splat_source.trace_splats(id, &mut |splat| {
                if splat.color.iter().all(|value| value.is_finite()) {
                    splats.add(&splat);
                } else {
                    self.defects.add(Defect::NonFinite, id);
                }
            });
        }
    }

    /// Takes the samples of a batch, adds them to their pixels, and empties the batch.
    fn take<S: SampleSource>(&mut self, source: &S, batch: &mut Batch) {
        let extra_count = batch.extra_count;
        batch.channels.resize(batch.ids.len() * extra_count, 0.0);
        source.take_samples(&batch.ids, &mut batch.channels, &mut batch.samples);
        with_lanes!(Level::new(), simd => self.add_batch(simd, batch));
    }

    /// Adds the samples of a batch to their pixels, and empties the batch.
    #[inline(always)]
    fn add_batch<V: Simd>(&mut self, simd: V, batch: &mut Batch) {
        let extra_count = batch.extra_count;
        // By reference: taken out one by one, ids of twelve bytes would be read back in pieces that
        // the processor cannot forward, half of the time that sums take.
        for (place, (id, sample)) in batch.ids.iter().zip(&batch.samples).enumerate() {
            let channels = &batch.channels[place * extra_count..(place + 1) * extra_count];
            self.add(simd, *id, sample, channels);
        }
        batch.ids.clear();
        batch.samples.clear();
    }

    #[inline(always)]
    fn add<V: Simd>(&mut self, simd: V, id: SampleId, sample: &Sample, channels: &[f32]) {
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

/// How many samples are asked for at once: enough for the source to find many alike among them, few
/// enough that what it keeps of them, some 300 bytes each, stays in the caches of one core. From 256
/// to 1024 renders gain 3 %, from there to 2048 1 to 2 %, and with 4096 nothing more.
const BATCH_SIZE: usize = 2048;

/// Samples that are taken together.
struct Batch {
    extra_count: usize,
    ids: Vec<SampleId>,
    samples: Vec<Sample>,
    /// The channels of all samples, one after the other.
    channels: Vec<f32>,
}

impl Batch {
    fn new(extra_count: usize) -> Self {
        Self {
            extra_count,
            ids: Vec::with_capacity(BATCH_SIZE),
            samples: Vec::with_capacity(BATCH_SIZE),
            channels: Vec::with_capacity(BATCH_SIZE * extra_count),
        }
    }
}

/// Why a sample cannot be part of a picture, if it cannot. Only light has a sign to be wrong:
/// channels such as positions may be negative, and so may the filter's weight.
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
