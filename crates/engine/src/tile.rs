//! A small rectangle of pixels and the sums of its samples: what one thread works on at a time.

use std::ops::Range;

use crate::SampleId;
use crate::region::Region;
use crate::source::{Sample, SampleSource};
use crate::statistics::{Defect, Defects};

/// Red, green, blue and alpha; the extra layers follow.
pub(crate) const COLOR_CHANNELS: usize = 4;

/// The sums of one rectangle of pixels, row by row.
///
/// A tile belongs to one thread at a time, so nothing here is shared or locked.
#[derive(Debug)]
pub(crate) struct Tile {
    region: Region,
    /// Channels per pixel, alpha included.
    channel_count: usize,
    /// Σ weight·value of every channel, pixel after pixel.
    sums: Vec<f64>,
    /// Σ (weight·value)² of red, green and blue.
    squares: Vec<[f64; 3]>,
    /// Samples in the sums.
    counts: Vec<u32>,
    /// What a sample writes its layers to.
    layers: Vec<f32>,
    /// Samples that every pixel was given, those left out included.
    samples_per_pixel: u32,
    defects: Defects,
}

/// The sums of one pixel.
pub(crate) struct PixelSums<'a> {
    /// Σ weight·value of every channel.
    pub(crate) sums: &'a [f64],
    /// Σ (weight·value)² of red, green and blue.
    pub(crate) squares: [f64; 3],
    /// Samples in the sums.
    pub(crate) count: u32,
}

impl Tile {
    pub(crate) fn new(region: Region, layer_count: usize) -> Self {
        let pixel_count = region.pixel_count() as usize;
        let channel_count = COLOR_CHANNELS + layer_count;
        Self {
            region,
            channel_count,
            sums: vec![0.0; pixel_count * channel_count],
            squares: vec![[0.0; 3]; pixel_count],
            counts: vec![0; pixel_count],
            layers: vec![0.0; layer_count],
            samples_per_pixel: 0,
            defects: Defects::default(),
        }
    }

    /// Where the tile lies in the film.
    pub(crate) fn region(&self) -> Region {
        self.region
    }

    /// How many samples every pixel was given, those left out included.
    pub(crate) fn samples_per_pixel(&self) -> u32 {
        self.samples_per_pixel
    }

    /// The samples that were left out.
    pub(crate) fn defects(&self) -> &Defects {
        &self.defects
    }

    /// The pixels, row by row.
    pub(crate) fn pixels(&self) -> impl Iterator<Item = PixelSums<'_>> {
        let sums = self.sums.chunks_exact(self.channel_count);
        sums.zip(&self.squares).zip(&self.counts).map(|((sums, &squares), &count)| PixelSums {
            sums,
            squares,
            count,
        })
    }

    /// Adds a range of sample indices to every pixel; returns how many samples were taken.
    ///
    /// The samples of a pixel are added one by one in the order of their indices, so that the sums
    /// do not depend on how the indices were divided into ranges.
    pub(crate) fn render<S: SampleSource>(&mut self, source: &S, indices: Range<u32>) -> u64 {
        let Region { x, y, width, height } = self.region;
        for row in 0..height {
            for column in 0..width {
                let pixel = row as usize * width as usize + column as usize;
                self.render_pixel(source, pixel, [x + column, y + row], indices.clone());
            }
        }
        let count = indices.end - indices.start;
        self.samples_per_pixel += count;
        self.region.pixel_count() * u64::from(count)
    }

    fn render_pixel<S: SampleSource>(
        &mut self,
        source: &S,
        pixel: usize,
        [x, y]: [u32; 2],
        indices: Range<u32>,
    ) {
        let start = pixel * self.channel_count;
        let sums = &mut self.sums[start..start + self.channel_count];
        let squares = &mut self.squares[pixel];
        for index in indices {
            let id = SampleId { index, y, x };
            let sample = source.sample(id, &mut self.layers);
            if let Some(defect) = find_defect(&sample, &self.layers) {
                self.defects.add(defect, id);
                continue;
            }
            self.counts[pixel] += 1;
            add(sums, squares, &sample, &self.layers);
        }
    }
}

/// Why a sample cannot be part of a picture, if it cannot. Only light has a sign to be wrong:
/// layers such as positions may be negative, and so may the filter's weight.
fn find_defect(sample: &Sample, layers: &[f32]) -> Option<Defect> {
    let finite = sample.color.is_finite() && sample.alpha.is_finite();
    if !finite || layers.iter().any(|value| !value.is_finite()) {
        Some(Defect::NonFinite)
    } else if sample.color.has_negative() {
        Some(Defect::Negative)
    } else {
        None
    }
}

fn add(sums: &mut [f64], squares: &mut [f64; 3], sample: &Sample, layers: &[f32]) {
    let weight = f64::from(sample.weight);
    let (color_sums, layer_sums) = sums.split_at_mut(COLOR_CHANNELS);
    let rgb = sample.color.rgb().map(|value| weight * f64::from(value));
    for channel in 0..3 {
        color_sums[channel] += rgb[channel];
        squares[channel] += rgb[channel] * rgb[channel];
    }
    color_sums[3] += weight * f64::from(sample.alpha);
    for (sum, &value) in layer_sums.iter_mut().zip(layers) {
        *sum += weight * f64::from(value);
    }
}
