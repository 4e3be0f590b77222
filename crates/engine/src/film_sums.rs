//! The sums of all pixels, and the picture they make.

use std::ops::Range;

use etendue_image::Picture;
use rayon::prelude::*;

use crate::EngineError;
use crate::region::Region;
use crate::source::SampleSource;
use crate::statistics::Defects;
use crate::tile::{COLOR_CHANNELS, PixelSums, Tile};

/// What every sample so far adds up to, per pixel and channel, in double precision.
#[derive(Debug)]
pub struct FilmSums {
    region: Region,
    layer_names: Vec<String>,
    tiles: Vec<Tile>,
}

/// Which channels a picture gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Channels {
    /// Whether alpha follows red, green and blue.
    pub alpha: bool,
    /// Whether the variance of each pixel's mean follows as the layers `variance.R`, `.G`, `.B`.
    pub variance: bool,
}

/// The names of the variance layers.
const VARIANCE_NAMES: [&str; 3] = ["variance.R", "variance.G", "variance.B"];

impl FilmSums {
    /// Sums without samples, of tiles that suit the number of threads.
    ///
    /// # Errors
    ///
    /// [`EngineError::BadRegion`] if there are no pixels; [`EngineError::FilmTooLarge`] if the
    /// sums and the finished picture would take more than `memory_limit` bytes.
    pub(crate) fn new(
        region: Region,
        layer_names: &[String],
        thread_count: usize,
        memory_limit: u64,
    ) -> Result<Self, EngineError> {
        if region.pixel_count() == 0 {
            return Err(EngineError::BadRegion);
        }
        let bytes = Self::memory_needed(region, layer_names.len());
        if bytes > memory_limit {
            let Region { width, height, .. } = region;
            return Err(EngineError::FilmTooLarge { width, height, bytes, limit: memory_limit });
        }
        let tiles = region.tiles(thread_count);
        let tiles = tiles.into_iter().map(|tile| Tile::new(tile, layer_names.len())).collect();
        Ok(Self { region, layer_names: layer_names.to_vec(), tiles })
    }

    /// The bytes that the sums of a region and its finished picture take together.
    pub fn memory_needed(region: Region, layer_count: usize) -> u64 {
        let channel_count = (COLOR_CHANNELS + layer_count) as u64;
        let sums = 8 * channel_count + 3 * 8 + 4;
        let picture = 4 * (channel_count + VARIANCE_NAMES.len() as u64);
        region.pixel_count().saturating_mul(sums + picture)
    }

    /// Where the pixels lie in the film.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Adds samples to every pixel, tile by tile on the threads of the current pool.
    ///
    /// `go_on` is asked before every tile, and `done` told after it how many samples it took.
    pub(crate) fn add_samples<S: SampleSource>(
        &mut self,
        source: &S,
        indices: Range<u32>,
        go_on: &(impl Fn() -> bool + Sync),
        done: &(impl Fn(u64) + Sync),
    ) {
        // Single tiles are what threads take from each other: rayon's own grain would hand out
        // long runs of tiles, whose cost may differ by a factor of ten.
        self.tiles.par_iter_mut().with_max_len(1).for_each(|tile| {
            if go_on() {
                done(tile.render(source, indices.clone()));
            }
        });
    }

    /// The least and the greatest number of samples that any pixel was given.
    pub fn samples_per_pixel(&self) -> [u32; 2] {
        let counts = || self.tiles.iter().map(Tile::samples_per_pixel);
        [counts().min().unwrap_or(0), counts().max().unwrap_or(0)]
    }

    /// The samples that were left out so far.
    pub(crate) fn defects(&self) -> Defects {
        let mut defects = Defects::default();
        for tile in &self.tiles {
            defects.merge(tile.defects());
        }
        defects
    }

    /// The picture so far: `R`, `G`, `B`, then what `channels` asks for, then the layers.
    ///
    /// A pixel without samples is zero in every channel.
    pub fn develop(&self, channels: Channels) -> Picture {
        let mut picture = Picture::new(self.region.width, self.region.height);
        let offset = |value: u32| i32::try_from(value).unwrap_or(i32::MAX);
        picture.data_origin = [offset(self.region.x), offset(self.region.y)];
        for (channel, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
            if channel < 3 || channels.alpha {
                picture.push(name, self.plane(|pixel| mean(pixel, channel)));
            }
        }
        for (layer, name) in self.layer_names.iter().enumerate() {
            picture.push(name, self.plane(|pixel| mean(pixel, COLOR_CHANNELS + layer)));
        }
        for (channel, name) in VARIANCE_NAMES.into_iter().enumerate() {
            if channels.variance {
                picture.push(name, self.plane(|pixel| variance_of_mean(pixel, channel)));
            }
        }
        picture
    }

    /// One value per pixel, row by row.
    fn plane(&self, value: impl Fn(&PixelSums<'_>) -> f64) -> Vec<f32> {
        let width = self.region.width as usize;
        let mut plane = vec![0.0; self.region.pixel_count() as usize];
        for tile in &self.tiles {
            let region = tile.region();
            let left = (region.x - self.region.x) as usize;
            let top = (region.y - self.region.y) as usize;
            for (index, pixel) in tile.pixels().enumerate() {
                let (row, column) = (index / region.width as usize, index % region.width as usize);
                plane[(top + row) * width + left + column] = value(&pixel) as f32;
            }
        }
        plane
    }
}

fn mean(pixel: &PixelSums<'_>, channel: usize) -> f64 {
    if pixel.count == 0 { 0.0 } else { pixel.sums[channel] / f64::from(pixel.count) }
}

/// The unbiased estimate (Σv² − (Σv)²/n) / (n − 1) of a sample's variance, over n. With fewer than
/// two samples nothing is known, which is said as zero.
fn variance_of_mean(pixel: &PixelSums<'_>, channel: usize) -> f64 {
    if pixel.count < 2 {
        return 0.0;
    }
    let count = f64::from(pixel.count);
    let sum = pixel.sums[channel];
    let spread = pixel.squares[channel] - sum * sum / count;
    // Rounding can leave a constant pixel a hair below zero.
    spread.max(0.0) / (count - 1.0) / count
}
