//! A small rectangle of pixels and the sums of its samples. One thread at a time adds to it.

use std::sync::Arc;

use crate::exact_sums::{ExactSums, SumsMut};
use crate::nearest::{Key, Nearest};
use crate::region::Region;
use crate::source::{Sample, SampleId};
use crate::statistics::{Defect, Defects};
use etendue_integrators::ChannelKind;
use etendue_math::lanes::{Level, Simd};
use etendue_math::with_lanes;

/// Red, green, blue and alpha; the extra channels follow.
pub(crate) const COLOR_CHANNELS: usize = 4;

/// Red, green and blue have variances.
pub(crate) const VARIANCE_CHANNELS: usize = 3;

/// The sums of one rectangle of pixels, row by row.
#[derive(Clone, Debug)]
pub(crate) struct Tile {
    pub(crate) region: Region,
    /// How the extra channels are combined.
    kinds: Arc<[ChannelKind]>,
    /// Sums per pixel: colour, alpha, and the extra channels that have means.
    channel_count: usize,
    /// Σ weight·value of every channel, pixel after pixel.
    pub(crate) sums: ExactSums,
    /// The extra channels that belong to the sample nearest to each pixel's centre.
    pub(crate) nearest: Nearest,
    /// Samples in the sums.
    pub(crate) counts: Vec<u32>,
    /// Σ weight·value of red, green and blue of the samples with odd index; empty without variances.
    pub(crate) odd_sums: ExactSums,
    /// Samples in these sums; empty without variances.
    pub(crate) odd_counts: Vec<u32>,
    /// The index of every pixel's next sample.
    pub(crate) next_sample: u32,
    pub(crate) defects: Defects,
    /// Whether samples of negative light are kept, instead of being defects.
    pub(crate) keeps_negative: bool,
}

/// What the tiles of a film have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileKind {
    /// Channels beyond red, green, blue and alpha that have means.
    pub(crate) mean_channel_count: usize,
    /// Channels of the sample nearest to a pixel's centre.
    pub(crate) nearest_channel_count: usize,
    /// Whether samples with odd index are summed apart too, for variances.
    pub(crate) variance: bool,
    /// Whether samples have splats, which belong to the film as a whole.
    pub(crate) splats: bool,
    /// The index of every pixel's first sample.
    pub(crate) first_sample: u32,
}

impl TileKind {
    /// Counts the channels of each kind.
    pub(crate) fn with_channels(self, kinds: &[ChannelKind]) -> Self {
        let count = |kind| kinds.iter().filter(|other| **other == kind).count();
        Self {
            mean_channel_count: count(ChannelKind::Mean),
            nearest_channel_count: count(ChannelKind::Nearest),
            ..self
        }
    }

    /// How many sums a pixel has.
    pub(crate) fn sums_per_pixel(self) -> u64 {
        let odd = if self.variance { VARIANCE_CHANNELS } else { 0 };
        (COLOR_CHANNELS + self.mean_channel_count + odd) as u64
    }

    /// The bytes of what a pixel counts, sums and keeps.
    pub(crate) fn bytes_per_pixel(self) -> u64 {
        let counts = if self.variance { 2 } else { 1 };
        ExactSums::BYTES * self.sums_per_pixel()
            + counts * size_of::<u32>() as u64
            + Nearest::bytes_per_pixel(self.nearest_channel_count)
    }
}

impl Tile {
    pub(crate) fn new(region: Region, kind: TileKind, kinds: Arc<[ChannelKind]>) -> Self {
        let pixel_count = region.pixel_count() as usize;
        let channel_count = COLOR_CHANNELS + kind.mean_channel_count;
        let odd_count = if kind.variance { pixel_count } else { 0 };
        Self {
            region,
            kinds,
            channel_count,
            sums: ExactSums::new(pixel_count * channel_count),
            nearest: Nearest::new(pixel_count, kind.nearest_channel_count),
            counts: vec![0; pixel_count],
            odd_sums: ExactSums::new(odd_count * VARIANCE_CHANNELS),
            odd_counts: vec![0; odd_count],
            next_sample: kind.first_sample,
            defects: Defects::default(),
            keeps_negative: false,
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
        if !self.odd_counts.is_empty() {
            let (count, others) = (&mut self.odd_counts[pixel], other.odd_counts[other_pixel]);
            *count = count.saturating_add(others);
            merge(&mut self.odd_sums, &other.odd_sums, VARIANCE_CHANNELS);
        }
        if !self.nearest.is_empty() {
            self.nearest.merge_pixel(pixel, &other.nearest, other_pixel);
        }
    }

    /// The mean of a channel of a pixel; zero without samples.
    pub(crate) fn mean(&self, pixel: usize, channel: usize) -> f64 {
        match self.counts[pixel] {
            0 => 0.0,
            count => self.sum(pixel, channel) / f64::from(count),
        }
    }

    /// An estimate of the variance of the mean of red, green or blue, with one degree of freedom.
    /// `None` without variances, or if there are no samples with even or with odd index.
    ///
    /// The two halves are independent, whatever dependence the sampler has made within them. Let a
    /// half of n samples have the variance s/n. Then the squared difference of the means has the
    /// expectation s (1/n₀ + 1/n₁), and the mean of all has the variance s / (n₀ + n₁).
    pub(crate) fn variance_of_mean(&self, pixel: usize, channel: usize) -> Option<f64> {
        let odd_count = *self.odd_counts.get(pixel)?;
        let even_count = self.counts[pixel].checked_sub(odd_count)?;
        if odd_count == 0 || even_count == 0 {
            return None;
        }
        let odd = self.odd_sums.value(pixel * VARIANCE_CHANNELS + channel);
        let even = self.sum(pixel, channel) - odd;
        let [even_count, odd_count] = [even_count, odd_count].map(f64::from);
        let difference = even / even_count - odd / odd_count;
        let count = even_count + odd_count;
        Some((difference / count).powi(2) * even_count * odd_count)
    }

    /// Whether single precision holds the mean of every pixel in every channel.
    pub(crate) fn is_finite(&self) -> bool {
        let channels = 0..self.channel_count;
        let is_finite = |pixel: usize| {
            channels.clone().all(|channel| (self.mean(pixel, channel) as f32).is_finite())
        };
        (0..self.counts.len()).all(is_finite)
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
        let extra_channel_count = self.kinds.len();
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
        let defect = find_defect(sample, channels);
        let is_kept = defect == Some(Defect::Negative) && self.keeps_negative;
        if let Some(defect) = defect.filter(|_| !is_kept) {
            self.defects.add(defect, id);
            return;
        }
        let row = (id.y - self.region.y) as usize;
        let pixel = row * self.region.width as usize + (id.x - self.region.x) as usize;
        self.counts[pixel] += 1;
        let place = pixel * self.channel_count;
        let sums = &mut self.sums.slice_mut(place, self.channel_count);
        if self.nearest.is_empty() {
            add(simd, sums, sample, channels.iter().copied());
        } else {
            let of_kind = |kind: ChannelKind| {
                let pairs = channels.iter().zip(&*self.kinds);
                pairs.filter(move |(_, other)| **other == kind).map(|(value, _)| *value)
            };
            add(simd, sums, sample, of_kind(ChannelKind::Mean));
            let key = Key::new(sample.squared_distance, id.index);
            self.nearest.add(pixel, key, of_kind(ChannelKind::Nearest));
        }
        if id.index % 2 == 1 && !self.odd_counts.is_empty() {
            self.odd_counts[pixel] += 1;
            let place = pixel * VARIANCE_CHANNELS;
            add_color(&mut self.odd_sums.slice_mut(place, VARIANCE_CHANNELS), sample);
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
fn add<V: Simd>(
    simd: V,
    sums: &mut SumsMut<'_>,
    sample: &Sample,
    channels: impl Iterator<Item = f32>,
) {
    let weight = f64::from(sample.weight);
    let [red, green, blue] = sample.color.rgb();
    let values: [f32; COLOR_CHANNELS] = [red, green, blue, sample.alpha];
    sums.add_four(simd, 0, values.map(|value| weight * f64::from(value)));
    for (index, value) in channels.enumerate() {
        sums.add(COLOR_CHANNELS + index, weight * f64::from(value));
    }
}

#[inline(always)]
fn add_color(sums: &mut SumsMut<'_>, sample: &Sample) {
    let weight = f64::from(sample.weight);
    for (channel, value) in sample.color.rgb().into_iter().enumerate() {
        sums.add(channel, weight * f64::from(value));
    }
}
