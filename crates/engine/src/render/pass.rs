//! One pass over the picture: tile after tile, on all threads.

use std::cell::Cell;

use etendue_integrators::Watch;
use rayon::prelude::*;

use crate::clock::{FinishedTile, PassClock};
use crate::film_sums::{FilmSums, Turn};
use crate::region::Region;
use crate::source::{BATCH_SIZE, Sample, SampleId, SampleSource, SplatSource};
use crate::splats::{PixelSplat, Splats};
use crate::statistics::{Defect, Defects};
use crate::tile::Tile;

/// Gives every pixel its samples with an index below `end`, on the threads of the current pool.
pub(super) fn render_pass<S: SampleSource>(
    source: &S,
    film: &FilmSums,
    end: u32,
    clock: &PassClock<'_>,
) {
    let keeps_negative = source.is_out_of_gamut();
    // Threads take single tiles from each other: rayon's own grain would hand out long runs of
    // tiles, whose cost may differ by a factor of ten.
    (0..film.tile_count()).into_par_iter().with_max_len(1).for_each(|index| {
        if clock.may_go_on() {
            let turn = &mut film.begin_turn(index);
            turn.tile.keeps_negative = keeps_negative;
            clock.count(render_tile(source, turn, end, clock));
        }
    });
}

/// Gives the pixels of a tile their samples with an index below `end`. If the samples take too long,
/// the tile stays as it is.
fn render_tile<S: SampleSource>(
    source: &S,
    turn: &mut Turn<'_>,
    end: u32,
    clock: &PassClock<'_>,
) -> FinishedTile {
    let is_final = Cell::new(false);
    let is_over = || !is_final.get() && clock.is_over();
    let watch = Watch::new(&is_over);
    let count = end.saturating_sub(turn.tile.next_sample);
    if count == 0 {
        return FinishedTile::default();
    }
    let samples = turn.tile.region.pixel_count() * u64::from(count);
    // If there are several batches, the last one may be abandoned when others are in the sums.
    let before = (samples > BATCH_SIZE as u64).then(|| turn.tile.clone());
    if take_all(source, turn, end, (&watch, &is_final)).is_some() {
        return FinishedTile { samples, truncated_paths: watch.truncated_paths() };
    }
    if let Some(before) = before {
        *turn.tile = before;
    }
    FinishedTile::default()
}

/// Takes the samples of a tile's pixels with an index below `end`. `None` if they were abandoned: the
/// film has none of their splats, but the tile may have some of the samples. Once the film has splats,
/// `is_final` is set, and the samples are no longer abandoned.
fn take_all<S: SampleSource>(
    source: &S,
    turn: &mut Turn<'_>,
    end: u32,
    (watch, is_final): (&Watch<'_>, &Cell<bool>),
) -> Option<()> {
    let Turn { tile, splats, .. } = turn;
    let mut ids = sample_ids(tile, end);
    let splat_source = source.splats().zip(*splats);
    let mut found = FoundSplats::default();
    if let Some((source, splats)) = splat_source {
        ids.clone().try_for_each(|id| {
            found.trace(source, id, watch)?;
            if found.splats.len() > MAX_SPLATS {
                is_final.set(true);
                found.add_to(splats);
            }
            Some(())
        })?;
    }
    let mut batch = Batch::new(source.channels().len());
    ids.try_for_each(|id| {
        batch.ids.push(id);
        if batch.ids.len() == BATCH_SIZE { batch.take(source, watch, tile) } else { Some(()) }
    })?;
    batch.take(source, watch, tile)?;
    tile.next_sample = end;
    tile.defects.merge(&found.defects);
    if let Some((_, splats)) = splat_source {
        found.add_to(splats);
    }
    Some(())
}

/// The samples of a tile's pixels with an index below `end`, pixel by pixel.
fn sample_ids(tile: &Tile, end: u32) -> impl Iterator<Item = SampleId> + Clone + use<> {
    let Region { x: left, y: top, width, height } = tile.region;
    let first = tile.next_sample;
    (top..top + height).flat_map(move |y| {
        (left..left + width)
            .flat_map(move |x| (first..end).map(move |index| SampleId { index, y, x }))
    })
}

/// The most splats that wait for the end of a tile: 128 MB.
const MAX_SPLATS: usize = 1 << 22;

/// The splats of a tile's samples. The film gets them when all of its samples are taken.
#[derive(Default)]
struct FoundSplats {
    splats: Vec<PixelSplat>,
    defects: Defects,
}

impl FoundSplats {
    /// Traces the splats of a sample; `None` if they were abandoned.
    fn trace(&mut self, source: &dyn SplatSource, id: SampleId, watch: &Watch<'_>) -> Option<()> {
        source.trace_splats(id, watch, &mut |splat| {
            if splat.color.iter().all(|value| value.is_finite()) {
                self.splats.push(splat);
            } else {
                self.defects.add(Defect::NonFinite, id);
            }
        });
        (!watch.is_abandoned()).then_some(())
    }

    /// Adds the splats to the film's.
    fn add_to(&mut self, splats: &Splats) {
        self.splats.drain(..).for_each(|splat| splats.add(&splat));
    }
}

/// The samples that a source is asked for at once.
struct Batch {
    extra_channel_count: usize,
    ids: Vec<SampleId>,
    samples: Vec<Sample>,
    /// The extra channels, sample after sample.
    channels: Vec<f32>,
}

impl Batch {
    fn new(extra_channel_count: usize) -> Self {
        Self {
            extra_channel_count,
            ids: Vec::with_capacity(BATCH_SIZE),
            samples: Vec::with_capacity(BATCH_SIZE),
            channels: Vec::with_capacity(BATCH_SIZE * extra_channel_count),
        }
    }

    /// Takes the samples, adds them to their tile, and leaves the batch empty; `None` if they were
    /// abandoned.
    fn take<S: SampleSource>(
        &mut self,
        source: &S,
        watch: &Watch<'_>,
        tile: &mut Tile,
    ) -> Option<()> {
        self.channels.resize(self.ids.len() * self.extra_channel_count, 0.0);
        source.take_samples(&self.ids, &mut self.channels, watch, &mut self.samples);
        if watch.is_abandoned() {
            return None;
        }
        tile.add(&self.ids, &self.samples, &self.channels);
        self.ids.clear();
        self.samples.clear();
        Some(())
    }
}
