//! The sums of all pixels, and the picture they make.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLockReadGuard};

use etendue_image::Picture;
use etendue_integrators::ChannelKind;

use crate::error::EngineError;
use crate::job::Job;
use crate::region::Region;
use crate::source::SampleSource;
use crate::splats::Splats;
use crate::statistics::{Defects, SamplesPerPixel};
use crate::tile::{COLOR_CHANNELS, Tile, TileKind};
use crate::variance::{self, local_means};

/// The sums of all samples so far, per pixel and channel. The order of samples does not change them
/// (`exact_sums`).
///
/// Each tile has a lock. A thread holds it for one turn, while it renders the tile. So another thread
/// can develop a picture or write a checkpoint at any time: it sees every tile between two turns.
#[derive(Debug)]
pub struct FilmSums {
    region: Region,
    channel_names: Vec<String>,
    channel_kinds: Arc<[ChannelKind]>,
    kind: TileKind,
    tile_side: u32,
    tiles: Vec<Mutex<Tile>>,
    /// The sums of splats, if the source has any.
    splats: Option<Splats>,
}

/// What a film consists of before it has samples.
pub(crate) struct FilmLayout {
    pub(crate) region: Region,
    /// The names of the channels beside colour and alpha.
    pub(crate) channel_names: Vec<String>,
    /// One for each name.
    pub(crate) channel_kinds: Vec<ChannelKind>,
    pub(crate) kind: TileKind,
    pub(crate) tile_side: u32,
}

/// A tile while one thread adds samples to it, and the film's splats.
pub(crate) struct Turn<'a> {
    pub(crate) tile: MutexGuard<'a, Tile>,
    pub(crate) splats: Option<&'a Splats>,
    /// Whoever reads the splats waits until it is dropped.
    _splats_turn: Option<RwLockReadGuard<'a, ()>>,
}

/// Which channels a picture gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Channels {
    /// Whether alpha follows red, green and blue.
    pub alpha: bool,
    /// Whether the variance of each pixel's mean follows as the layer `variance.R`, `.G`, `.B`,
    /// averaged over 5 × 5 pixels of the region. It is zero unless the [`Job`] asked for it, and
    /// where no pixel has two samples.
    pub variance: bool,
}

/// The layer of the variances.
pub(crate) const VARIANCE_LAYER: &str = "variance";

/// The names of the variances.
const VARIANCE_NAMES: [&str; 3] = ["variance.R", "variance.G", "variance.B"];

impl FilmSums {
    /// A film without samples. The number of threads decides the size of its tiles.
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
        let layout = FilmLayout {
            region: job.region,
            channel_names: source.channels().to_vec(),
            channel_kinds: source.channel_kinds(),
            kind: kind(job, source),
            tile_side: job.region.tile_side(thread_count),
        };
        Self::with_layout(layout, job.memory_limit)
    }

    /// A film without samples.
    pub(crate) fn with_layout(layout: FilmLayout, memory_limit: u64) -> Result<Self, EngineError> {
        let FilmLayout { region, channel_names, channel_kinds, kind, tile_side } = layout;
        if region.pixel_count() == 0 {
            return Err(EngineError::BadRegion);
        }
        let bytes = memory_needed(region, kind);
        if bytes > memory_limit {
            let Region { width, height, .. } = region;
            return Err(EngineError::FilmTooLarge { width, height, bytes, limit: memory_limit });
        }
        let channel_kinds: Arc<[ChannelKind]> = channel_kinds.into();
        let new_tile = |tile| Mutex::new(Tile::new(tile, kind, Arc::clone(&channel_kinds)));
        let tiles = region.tiles(tile_side).into_iter().map(new_tile).collect();
        let splats = kind.splats.then(|| Splats::new(region));
        Ok(Self { region, channel_names, channel_kinds, kind, tile_side, tiles, splats })
    }

    /// The bytes that the film of a job and its finished picture take together.
    pub fn memory_needed<S: SampleSource>(job: &Job, source: &S) -> u64 {
        memory_needed(job.region, kind(job, source))
    }

    /// Where the pixels lie in the film.
    pub fn region(&self) -> Region {
        self.region
    }

    /// How many samples the pixels have, those left out included.
    pub fn samples_per_pixel(&self) -> SamplesPerPixel {
        let counts = self.tiles().map(|tile| tile.next_sample - self.kind.first_sample);
        counts
            .map(SamplesPerPixel::all)
            .reduce(|all, one| SamplesPerPixel {
                least: all.least.min(one.least),
                most: all.most.max(one.most),
            })
            .unwrap_or_default()
    }

    /// The index of every pixel's first sample.
    pub fn first_sample(&self) -> u32 {
        self.kind.first_sample
    }

    /// The least index that any pixel's next sample has.
    pub(crate) fn least_next_sample(&self) -> u32 {
        self.first_sample() + self.samples_per_pixel().least
    }

    /// The number of samples of all pixels together, those left out included.
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

    /// The picture so far: `R`, `G`, `B`, alpha if `channels` asks for it, the source's own channels,
    /// and variances if `channels` asks for them.
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
        // The places of the next channel of each kind.
        let (mut mean, mut nearest) = (COLOR_CHANNELS, 0);
        for (name, kind) in self.channel_names.iter().zip(&*self.channel_kinds) {
            let plane = match kind {
                ChannelKind::Mean => self.plane(|tile, pixel| tile.mean(pixel, mean)),
                ChannelKind::Nearest => {
                    self.plane(|tile, pixel| f64::from(tile.nearest.value(pixel, nearest)))
                }
            };
            picture.push(name, plane);
            match kind {
                ChannelKind::Mean => mean += 1,
                ChannelKind::Nearest => nearest += 1,
            }
        }
        for (channel, name) in VARIANCE_NAMES.into_iter().enumerate() {
            if channels.variance {
                picture.push(name, self.variances(channel));
            }
        }
        picture
    }

    /// The variance of each pixel's mean, row by row; what a float cannot hold is clamped. A single
    /// pixel has one degree of freedom, so the estimates of neighbours are averaged.
    fn variances(&self, channel: usize) -> Vec<f32> {
        let estimates = self.map_pixels(None, |tile, pixel| tile.variance_of_mean(pixel, channel));
        let means = local_means(&estimates, self.region.width as usize);
        means.into_iter().map(|mean| mean.min(f64::from(f32::MAX)) as f32).collect()
    }

    /// One value per pixel, row by row.
    fn plane(&self, value: impl Fn(&Tile, usize) -> f64) -> Vec<f32> {
        self.map_pixels(0.0, |tile, pixel| value(tile, pixel) as f32)
    }

    /// Anything per pixel, row by row.
    fn map_pixels<T: Clone>(&self, empty: T, value: impl Fn(&Tile, usize) -> T) -> Vec<T> {
        let width = self.region.width as usize;
        let mut plane = vec![empty; self.region.pixel_count() as usize];
        for tile in self.tiles() {
            let region = tile.region;
            let left = (region.x - self.region.x) as usize;
            let top = (region.y - self.region.y) as usize;
            for pixel in 0..region.pixel_count() as usize {
                let (row, column) = (pixel / region.width as usize, pixel % region.width as usize);
                plane[(top + row) * width + left + column] = value(&tile, pixel);
            }
        }
        plane
    }

    /// Adds the samples of another film of the same pixels and channels. The two must not have a
    /// sample in common. The order of merges does not matter: the sums are those of one render.
    ///
    /// # Errors
    ///
    /// [`EngineError::OtherFilm`] if pixels, channels or variances are not the same, or if not all
    /// pixels of a film have the same number of samples.
    pub fn merge(&mut self, other: &Self) -> Result<(), EngineError> {
        let (own, others) = (self.samples_per_pixel(), other.samples_per_pixel());
        if !self.has_sums_of(other) || !own.is_even() || !others.is_even() {
            return Err(EngineError::OtherFilm);
        }
        self.kind.first_sample = self.kind.first_sample.min(other.kind.first_sample);
        let (first, count) = (self.kind.first_sample, own.least.saturating_add(others.least));
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

    /// Whether this is a film of the job's pixels with what the job and the source ask for.
    pub fn belongs_to<S: SampleSource>(&self, job: &Job, source: &S) -> bool {
        self.region == job.region
            && self.channel_names == source.channels()
            && self.kind == kind(job, source)
    }

    /// Whether the two films have the same sums, apart from samples and tiles.
    fn has_sums_of(&self, other: &Self) -> bool {
        self.region == other.region
            && self.channel_names == other.channel_names
            && self.channel_kinds == other.channel_kinds
            && self.kind.variance == other.kind.variance
            && self.kind.splats == other.kind.splats
    }

    /// Adds a tile of a film whose tiles may be of another size. `places` is [`Self::tile_places`].
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

    /// The names of the channels beside colour and alpha.
    pub fn channel_names(&self) -> &[String] {
        &self.channel_names
    }

    /// How the channels beside colour and alpha are combined.
    pub(crate) fn channel_kinds(&self) -> &[ChannelKind] {
        &self.channel_kinds
    }

    /// Whether the film can tell variances.
    pub fn has_variance(&self) -> bool {
        self.kind.variance
    }

    /// The sums of splats, if the source has any.
    pub(crate) fn splats(&self) -> Option<&Splats> {
        self.splats.as_ref()
    }

    /// The side of the tiles, apart from those that the film's edge cuts.
    pub(crate) fn tile_side(&self) -> u32 {
        self.tile_side
    }

    pub(crate) fn tile_count(&self) -> usize {
        self.tiles.len()
    }

    /// Waits for a tile, and holds it until the turn is dropped.
    pub(crate) fn begin_turn(&self, index: usize) -> Turn<'_> {
        let splats = self.splats.as_ref();
        let _splats_turn = splats.map(Splats::begin_turn);
        Turn { tile: self.tile(index), splats, _splats_turn }
    }

    /// One tile, locked.
    pub(crate) fn tile(&self, index: usize) -> MutexGuard<'_, Tile> {
        lock(&self.tiles[index])
    }

    /// The tiles, each locked while the caller has it.
    fn tiles(&self) -> impl Iterator<Item = MutexGuard<'_, Tile>> {
        self.tiles.iter().map(lock)
    }

    /// The tiles, which nobody else can have.
    pub(crate) fn tiles_mut(&mut self) -> impl Iterator<Item = &mut Tile> {
        self.tiles.iter_mut().map(unlocked)
    }
}

fn kind<S: SampleSource>(job: &Job, source: &S) -> TileKind {
    TileKind {
        mean_channel_count: 0,
        nearest_channel_count: 0,
        variance: job.variance,
        splats: source.splats().is_some(),
        first_sample: job.first_sample,
    }
    .with_channels(&source.channel_kinds())
}

fn memory_needed(region: Region, kind: TileKind) -> u64 {
    let splats = if kind.splats { Splats::BYTES_PER_PIXEL } else { 0 };
    let picture =
        size_of::<f32>() as u64 * (kind.sums_per_pixel() + kind.nearest_channel_count as u64);
    let averages = if kind.variance { variance::BYTES_PER_PIXEL } else { 0 };
    let per_pixel = kind.bytes_per_pixel() + splats + picture + averages;
    region.pixel_count().saturating_mul(per_pixel)
}

/// A poisoned lock is no harm: samples are taken before they are added, so a panic in one leaves the
/// sums whole.
fn lock(tile: &Mutex<Tile>) -> MutexGuard<'_, Tile> {
    tile.lock().unwrap_or_else(PoisonError::into_inner)
}

fn unlocked(tile: &mut Mutex<Tile>) -> &mut Tile {
    tile.get_mut().unwrap_or_else(PoisonError::into_inner)
}
