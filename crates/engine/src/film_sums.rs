//! The sums of all pixels, and the picture they make.

use std::sync::{Mutex, MutexGuard, PoisonError};

use etendue_image::Picture;
use rayon::prelude::*;

use crate::exact_sums::ExactSums;
use crate::region::Region;
use crate::source::SampleSource;
use crate::splats::Splats;
use crate::statistics::Defects;
use crate::tile::{COLOR_CHANNELS, Tile, TileKind};
use crate::{EngineError, Job};

/// What every sample so far adds up to, per pixel and channel, in sums that do not depend on any
/// order (`exact_sums`).
///
/// Each tile has a lock, which a thread holds while it renders the tile. So a picture can be
/// developed, or a checkpoint written, from another thread at any time: every tile is seen between
/// two of its turns.
#[derive(Debug)]
pub struct FilmSums {
    region: Region,
    channel_names: Vec<String>,
    kind: TileKind,
    tile_side: u32,
    tiles: Vec<Mutex<Tile>>,
    /// What particles left, if there are any.
    splats: Option<Splats>,
}

/// Which channels a picture gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Channels {
    /// Whether alpha follows red, green and blue.
    pub alpha: bool,
    /// Whether the variance of each pixel's mean follows as the layers `variance.R`, `.G`, `.B`. It
    /// is zero unless the [`Job`] said that it would be wanted.
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
    /// sums and the finished picture would take more than the job allows.
    pub fn new<S: SampleSource>(
        job: &Job,
        source: &S,
        thread_count: usize,
    ) -> Result<Self, EngineError> {
        let tile_side = job.region.tile_side(thread_count);
        let kind = kind(job, source);
        Self::with_tiles(job.region, source.channels(), kind, (tile_side, job.memory_limit))
    }

    /// The same with tiles of a given side.
    pub(crate) fn with_tiles(
        region: Region,
        channel_names: &[String],
        kind: TileKind,
        (tile_side, memory_limit): (u32, u64),
    ) -> Result<Self, EngineError> {
        if region.pixel_count() == 0 {
            return Err(EngineError::BadRegion);
        }
        let bytes = memory_needed(region, kind);
        if bytes > memory_limit {
            let Region { width, height, .. } = region;
            return Err(EngineError::FilmTooLarge { width, height, bytes, limit: memory_limit });
        }
        let tiles = region.tiles(tile_side);
        let tiles = tiles.into_iter().map(|tile| Mutex::new(Tile::new(tile, kind))).collect();
        let splats = kind.splats.then(|| Splats::new(region));
        Ok(Self { region, channel_names: channel_names.to_vec(), kind, tile_side, tiles, splats })
    }

    /// The bytes that the sums of a job and its finished picture take together.
    pub fn memory_needed<S: SampleSource>(job: &Job, source: &S) -> u64 {
        memory_needed(job.region, kind(job, source))
    }

    /// Where the pixels lie in the film.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Gives every pixel its samples up to index `end`, tile by tile on the threads of the current
    /// pool.
    ///
    /// `go_on` is asked before every tile, and `done` told after it how many samples it took.
    pub(crate) fn add_samples<S: SampleSource>(
        &self,
        source: &S,
        end: u32,
        go_on: &(impl Fn() -> bool + Sync),
        done: &(impl Fn(u64) + Sync),
    ) {
        // Single tiles are what threads take from each other: rayon's own grain would hand out
        // long runs of tiles, whose cost may differ by a factor of ten.
        self.tiles.par_iter().with_max_len(1).for_each(|tile| {
            if go_on() {
                let _turn = self.splats.as_ref().map(Splats::begin_turn);
                done(lock(tile).render(source, end, self.splats.as_ref()));
            }
        });
    }

    /// The least and the greatest number of samples that any pixel was given.
    pub fn samples_per_pixel(&self) -> [u32; 2] {
        self.next_samples().map(|next| next - self.kind.first_sample)
    }

    /// The index of every pixel's first sample.
    pub fn first_sample(&self) -> u32 {
        self.kind.first_sample
    }

    /// The least and the greatest index that any pixel's next sample has.
    pub(crate) fn next_samples(&self) -> [u32; 2] {
        let all = self.tiles().map(|tile| tile.next_sample);
        let first = self.kind.first_sample;
        all.map(|next| [next, next])
            .reduce(|[least, most], [next, _]| [least.min(next), most.max(next)])
            .unwrap_or([first, first])
    }

    /// The samples in all pixels together, those left out included.
    pub fn sample_count(&self) -> u64 {
        let first = self.kind.first_sample;
        let count = |tile: &Tile| u64::from(tile.next_sample - first) * tile.region.pixel_count();
        self.tiles().map(|tile| count(&tile)).sum()
    }

    /// The samples that were left out so far.
    pub fn defects(&self) -> Defects {
        let mut defects = Defects::default();
        for tile in self.tiles() {
            defects.merge(&tile.defects);
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
                let mut plane = self.plane(|tile, pixel| tile.mean(pixel, channel));
                if let Some(splats) = self.splats.as_ref().filter(|_| channel < 3) {
                    splats.add_to(&mut plane, channel, self.sample_count());
                }
                picture.push(name, plane);
            }
        }
        for (index, name) in self.channel_names.iter().enumerate() {
            let channel = COLOR_CHANNELS + index;
            picture.push(name, self.plane(|tile, pixel| tile.mean(pixel, channel)));
        }
        for (channel, name) in VARIANCE_NAMES.into_iter().enumerate() {
            if channels.variance {
                picture.push(name, self.plane(|tile, pixel| tile.variance_of_mean(pixel, channel)));
            }
        }
        picture
    }

    /// One value per pixel, row by row.
    fn plane(&self, value: impl Fn(&Tile, usize) -> f64) -> Vec<f32> {
        let width = self.region.width as usize;
        let mut plane = vec![0.0; self.region.pixel_count() as usize];
        for tile in self.tiles() {
            let region = tile.region;
            let left = (region.x - self.region.x) as usize;
            let top = (region.y - self.region.y) as usize;
            for pixel in 0..region.pixel_count() as usize {
                let (row, column) = (pixel / region.width as usize, pixel % region.width as usize);
                plane[(top + row) * width + left + column] = value(&tile, pixel) as f32;
            }
        }
        plane
    }

    /// Adds the samples of another film of the same pixels and layers, which it must not share any
    /// sample with. Whatever the order of merges, the sums are those of one render.
    ///
    /// # Errors
    ///
    /// [`EngineError::OtherFilm`] if pixels, layers or variances are not the same, or if a pixel of
    /// either has more or fewer samples than the rest.
    pub fn merge(&mut self, other: &Self) -> Result<(), EngineError> {
        let is_even = |film: &Self| {
            let [least, most] = film.samples_per_pixel();
            least == most
        };
        let sums = |film: &Self| {
            (film.region, film.channel_names.clone(), film.kind.variance, film.kind.splats)
        };
        let is_same = sums(self) == sums(other);
        if !is_same || !is_even(self) || !is_even(other) {
            return Err(EngineError::OtherFilm);
        }
        let [count, _] = self.samples_per_pixel();
        let [other_count, _] = other.samples_per_pixel();
        self.kind.first_sample = self.kind.first_sample.min(other.kind.first_sample);
        let (first, count) = (self.kind.first_sample, count.saturating_add(other_count));
        let places = self.tile_places();
        for tile in other.tiles() {
            self.merge_tile(&tile, &places);
        }
        for tile in self.tiles_mut() {
            tile.next_sample = first.saturating_add(count);
        }
        if let (Some(splats), Some(others)) = (&self.splats, &other.splats) {
            splats.merge(others);
        }
        Ok(())
    }

    /// Adds a tile of a film whose tiles may be of another size.
    fn merge_tile(&mut self, other: &Tile, places: &[usize]) {
        let Region { x, y, width, .. } = other.region;
        let columns = self.region.width.div_ceil(self.tile_side);
        for other_pixel in 0..other.counts.len() {
            // Tiles have at most 16 pixels on a side.
            let pixel_x = x + other_pixel as u32 % width;
            let pixel_y = y + other_pixel as u32 / width;
            let column = (pixel_x - self.region.x) / self.tile_side;
            let row = (pixel_y - self.region.y) / self.tile_side;
            let tile = unlocked(&mut self.tiles[places[(row * columns + column) as usize]]);
            let (left, top) = (pixel_x - tile.region.x, pixel_y - tile.region.y);
            let pixel = top * tile.region.width + left;
            tile.merge_pixel(pixel as usize, other, other_pixel);
            if other_pixel == 0 {
                tile.defects.merge(&other.defects);
            }
        }
    }

    /// The index of each tile, row by row.
    fn tile_places(&self) -> Vec<usize> {
        let columns = self.region.width.div_ceil(self.tile_side) as usize;
        let mut places = vec![0; self.tiles.len()];
        for (index, tile) in self.tiles().enumerate() {
            let column = (tile.region.x - self.region.x) / self.tile_side;
            let row = (tile.region.y - self.region.y) / self.tile_side;
            places[row as usize * columns + column as usize] = index;
        }
        places
    }

    /// The names of the layers beside the colour.
    pub fn channel_names(&self) -> &[String] {
        &self.channel_names
    }

    /// Whether squares are summed.
    pub fn has_variance(&self) -> bool {
        self.kind.variance
    }

    /// What particles left, if there are any.
    pub(crate) fn splats(&self) -> Option<&Splats> {
        self.splats.as_ref()
    }

    /// The side of all tiles but those that the film's edge cuts.
    pub(crate) fn tile_side(&self) -> u32 {
        self.tile_side
    }

    pub(crate) fn tile_count(&self) -> usize {
        self.tiles.len()
    }

    /// One tile, locked.
    pub(crate) fn tile(&self, index: usize) -> MutexGuard<'_, Tile> {
        lock(&self.tiles[index])
    }

    /// The tiles, each locked while it is looked at.
    fn tiles(&self) -> impl Iterator<Item = MutexGuard<'_, Tile>> {
        self.tiles.iter().map(lock)
    }

    /// The tiles while nobody else has any.
    pub(crate) fn tiles_mut(&mut self) -> impl Iterator<Item = &mut Tile> {
        self.tiles.iter_mut().map(unlocked)
    }
}

fn kind<S: SampleSource>(job: &Job, source: &S) -> TileKind {
    TileKind {
        extra_count: source.channels().len(),
        variance: job.variance,
        splats: source.splats().is_some(),
        first_sample: job.first_sample,
    }
}

fn memory_needed(region: Region, kind: TileKind) -> u64 {
    let splats = if kind.splats { Splats::BYTES_PER_PIXEL } else { 0 };
    let sums = ExactSums::BYTES * kind.sums_per_pixel() + 4 + splats;
    let picture = 4 * kind.sums_per_pixel();
    region.pixel_count().saturating_mul(sums + picture)
}

/// A panic in a sample leaves whole sums: they are only added to after it.
fn lock(tile: &Mutex<Tile>) -> MutexGuard<'_, Tile> {
    tile.lock().unwrap_or_else(PoisonError::into_inner)
}

fn unlocked(tile: &mut Mutex<Tile>) -> &mut Tile {
    tile.get_mut().unwrap_or_else(PoisonError::into_inner)
}
