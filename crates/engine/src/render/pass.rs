//! One pass over the picture: tile after tile, on all threads.

use rayon::prelude::*;

use crate::clock::PassClock;
use crate::film_sums::{FilmSums, Turn};
use crate::region::Region;
use crate::source::{BATCH_SIZE, Sample, SampleId, SampleSource, SplatSource};
use crate::splats::Splats;
use crate::statistics::Defect;
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
            clock.count(render_tile(source, turn, end));
        }
    });
}

/// Gives the pixels of a tile their samples with an index below `end`; returns how many it took.
fn render_tile<S: SampleSource>(source: &S, turn: &mut Turn<'_>, end: u32) -> u64 {
    let Turn { tile, splats, .. } = turn;
    let Region { x: left, y: top, width, height } = tile.region;
    let first = tile.next_sample;
    let count = end.saturating_sub(first);
    if count == 0 {
        return 0;
    }
    let splats = source.splats().zip(*splats);
    let mut batch = Batch::new(source.channels().len());
    for y in top..top + height {
        for x in left..left + width {
            let ids = (first..end).map(|index| SampleId { index, y, x });
            if let Some((source, splats)) = splats {
                ids.clone().for_each(|id| add_splats(source, id, splats, tile));
            }
            for id in ids {
                batch.ids.push(id);
                if batch.ids.len() == BATCH_SIZE {
                    batch.take(source, tile);
                }
            }
        }
    }
    batch.take(source, tile);
    tile.next_sample = end;
    tile.region.pixel_count() * u64::from(count)
}

/// Adds the splats of a sample to the film; the sample's tile keeps their defects.
fn add_splats(source: &dyn SplatSource, id: SampleId, splats: &Splats, tile: &mut Tile) {
    source.trace_splats(id, &mut |splat| {
        if splat.color.iter().all(|value| value.is_finite()) {
            splats.add(&splat);
        } else {
            tile.defects.add(Defect::NonFinite, id);
        }
    });
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

    /// Takes the samples, adds them to their tile, and leaves the batch empty.
    fn take<S: SampleSource>(&mut self, source: &S, tile: &mut Tile) {
        self.channels.resize(self.ids.len() * self.extra_channel_count, 0.0);
        source.take_samples(&self.ids, &mut self.channels, &mut self.samples);
        tile.add(&self.ids, &self.samples, &self.channels);
        self.ids.clear();
        self.samples.clear();
    }
}
