//! The random numbers of several paths at once, each with the bits of [`Sampler`]'s methods.

use super::{Sampler, SamplerKind, bits_of_dimension, is_independent, point_of_bits, sobol};
use etendue_math::lanes::{
    LaneArray, Lanes, MAX_LANES, Simd, Vector2, WordArray32, WordArray64, WordLanes32, WordLanes64,
};
use glam::Vec2;

/// The random numbers of a vertex of each of up to [`MAX_LANES`] paths.
#[derive(Clone, Copy, Debug, Default)]
pub struct RandomBatch {
    /// For the choice of an emitter and a point of it.
    pub light: [LaneArray; 2],
    /// For the direction in which the path goes on.
    pub direction: [LaneArray; 2],
    /// For decisions that gain nothing from being spread.
    pub choices: [LaneArray; 2],
}

/// How many dimensions a vertex takes.
const VERTEX_DIMENSIONS: u32 = 6;

/// What the numbers of several streams depend on.
#[derive(Default)]
struct Seeds {
    indices: WordArray32,
    sets: WordArray64,
    samples: WordArray64,
}

/// What several streams have in common.
#[derive(Clone, Copy)]
struct Place {
    kind: SamplerKind,
    dimension: u32,
}

/// Draws the numbers of a vertex for the paths that `chosen` names, each at most once, the first of
/// them in the first lane; those beyond [`MAX_LANES`] are left out. `stream` finds a path's stream.
///
/// A stream gives what `next_2d`, `next_2d` and `next_independent_2d` would give one after the other,
/// and stands where they would leave it. Lanes without a path hold any number below one.
#[inline(always)]
pub fn draw_vertices<S: Simd, P>(
    simd: S,
    paths: &mut [P],
    chosen: impl Iterator<Item = usize> + Clone,
    stream: impl Fn(&mut P) -> &mut Sampler,
    numbers: &mut RandomBatch,
) {
    let Some(path) = chosen.clone().next() else { return };
    let place = Place::of(stream(&mut paths[path]));
    let mut seeds = Seeds::default();
    let (mut count, mut difference) = (0, 0);
    for (lane, path) in chosen.clone().take(MAX_LANES).enumerate() {
        let stream = stream(&mut paths[path]);
        difference |= place.difference(Place::of(stream));
        seeds.set(lane, stream);
        stream.dimension = stream.dimension.wrapping_add(VERTEX_DIMENSIONS);
        count = lane + 1;
    }
    if difference == 0 && place.has_lanes() && place.after(2).has_lanes() {
        for first in (0..count).step_by(Lanes::<S>::COUNT) {
            seeds.draw(simd, place, first, numbers);
        }
        return;
    }
    for (lane, path) in chosen.take(MAX_LANES).enumerate() {
        let stream = stream(&mut paths[path]);
        stream.dimension = stream.dimension.wrapping_sub(VERTEX_DIMENSIONS);
        draw_alone(stream, numbers, lane);
    }
}

/// Draws `next_2d` of each stream, in order, and appends the points. The streams stand at the same
/// dimension.
#[inline(always)]
pub fn draw_points<S: Simd>(simd: S, streams: &mut [Sampler], points: &mut Vec<Vec2>) {
    for chunk in streams.chunks_mut(MAX_LANES) {
        let place = Place::of(&chunk[0]);
        if !place.has_lanes() || chunk.iter().any(|stream| place.difference(Place::of(stream)) != 0)
        {
            points.extend(chunk.iter_mut().map(Sampler::next_2d));
            continue;
        }
        let mut seeds = Seeds::default();
        for (lane, stream) in chunk.iter_mut().enumerate() {
            seeds.set(lane, stream);
            stream.dimension = place.after(2).dimension;
        }
        let mut drawn = [LaneArray::ZERO; 2];
        for first in (0..chunk.len()).step_by(Lanes::<S>::COUNT) {
            seeds.lanes(simd, first).point(place).store(&mut drawn, first);
        }
        let [x, y] = &drawn;
        points.extend((0..chunk.len()).map(|lane| Vec2::new(x.0[lane], y.0[lane])));
    }
}

impl Place {
    #[inline(always)]
    fn of(stream: &Sampler) -> Self {
        Self { kind: stream.kind, dimension: stream.dimension }
    }

    /// Zero where the two are the same: without a branch, as this is asked of every path.
    #[inline(always)]
    fn difference(self, other: Self) -> u32 {
        (self.kind as u32 ^ other.kind as u32) | (self.dimension ^ other.dimension)
    }

    /// So many dimensions on.
    #[inline(always)]
    fn after(self, dimensions: u32) -> Self {
        Self { dimension: self.dimension.wrapping_add(dimensions), ..self }
    }

    /// Whether points of these dimensions can be drawn in lanes.
    #[inline(always)]
    fn has_lanes(self) -> bool {
        self.kind == SamplerKind::Sobol || is_independent(self.kind, self.dimension)
    }
}

impl Seeds {
    #[inline(always)]
    fn set(&mut self, lane: usize, stream: &Sampler) {
        self.indices.0[lane] = stream.index;
        self.sets.0[lane] = stream.set_seed;
        self.samples.0[lane] = stream.sample_seed;
    }

    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, first: usize) -> SeedLanes<S> {
        SeedLanes {
            index: WordLanes32::load(simd, &self.indices, first),
            set: WordLanes64::load(simd, &self.sets, first),
            sample: WordLanes64::load(simd, &self.samples, first),
        }
    }

    #[inline(always)]
    fn draw<S: Simd>(&self, simd: S, place: Place, first: usize, numbers: &mut RandomBatch) {
        let seeds = self.lanes(simd, first);
        seeds.point(place).store(&mut numbers.light, first);
        seeds.point(place.after(2)).store(&mut numbers.direction, first);
        seeds.independent_point(place.after(4).dimension).store(&mut numbers.choices, first);
    }
}

/// [`Seeds`] in registers.
struct SeedLanes<S: Simd> {
    index: WordLanes32<S>,
    set: WordLanes64<S>,
    sample: WordLanes64<S>,
}

impl<S: Simd> SeedLanes<S> {
    #[inline(always)]
    fn independent_point(&self, dimension: u32) -> Vector2<Lanes<S>> {
        point_of_bits(bits_of_dimension(self.sample, dimension))
    }

    #[inline(always)]
    fn point(&self, Place { kind, dimension }: Place) -> Vector2<Lanes<S>> {
        if is_independent(kind, dimension) {
            return self.independent_point(dimension);
        }
        sobol::point(self.index, bits_of_dimension(self.set, dimension))
    }
}

/// Draws the numbers of one path.
#[cold]
fn draw_alone(stream: &mut Sampler, numbers: &mut RandomBatch, lane: usize) {
    Vector2::from(stream.next_2d()).put(&mut numbers.light, lane);
    Vector2::from(stream.next_2d()).put(&mut numbers.direction, lane);
    Vector2::from(stream.next_independent_2d()).put(&mut numbers.choices, lane);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SamplerSpec;
    use crate::sampler::tests::KINDS;
    use etendue_math::lanes::{Level, baseline};
    use etendue_math::with_lanes;
    use glam::UVec2;

    /// Streams that stand at `dimension`, but for some that `others` moves on.
    fn streams(kind: SamplerKind, dimension: u32, others: u32) -> Vec<Sampler> {
        let spec = SamplerSpec::new(kind, 9, 3);
        (0..40_u32)
            .map(|number| {
                let mut stream = spec.start(UVec2::new(number % 7, number), number * number);
                let moved = if number.is_multiple_of(5) { others } else { 0 };
                stream.set_dimension(dimension.wrapping_add(moved));
                stream
            })
            .collect()
    }

    /// Draws in lanes and one by one, and compares numbers and the places of all streams afterwards.
    fn compare(start: &[Sampler], chosen: &[usize]) {
        for level in [baseline(), Level::new()] {
            let (mut together, mut alone) = (start.to_vec(), start.to_vec());
            let mut block = RandomBatch::default();
            with_lanes!(level, simd => {
                let chosen = chosen.iter().copied();
                draw_vertices(simd, &mut together, chosen, |stream| stream, &mut block);
            });
            let mut expected = RandomBatch::default();
            for (lane, &path) in chosen.iter().take(MAX_LANES).enumerate() {
                draw_alone(&mut alone[path], &mut expected, lane);
            }
            assert_eq!(together, alone, "{level:?}");
            let lanes = chosen.len().min(MAX_LANES);
            let columns = |block: &RandomBatch| {
                [block.light, block.direction, block.choices]
                    .map(|point| point.map(|column| column.0[..lanes].to_vec()))
            };
            assert_eq!(columns(&block), columns(&expected), "{level:?}");
        }
    }

    #[test]
    fn lanes_draw_what_single_streams_draw() {
        for kind in KINDS {
            for dimension in [0, 3, 4, 12, 13, 14, 15, 16, 100, u32::MAX - 3, u32::MAX - 1] {
                for others in [0, 6] {
                    let start = streams(kind, dimension, others);
                    compare(&start, &[]);
                    compare(&start, &[7]);
                    compare(&start, &[39, 2, 17, 5, 0, 8, 9]);
                    compare(&start, &(3..3 + MAX_LANES).collect::<Vec<_>>());
                    compare(&start, &(0..40).rev().collect::<Vec<_>>());
                }
            }
        }
    }

    #[test]
    fn points_are_those_of_single_streams() {
        for kind in KINDS {
            for (dimension, others) in [(0, 0), (3, 0), (15, 0), (16, 0), (4, 6)] {
                let start = streams(kind, dimension, others);
                for level in [baseline(), Level::new()] {
                    let (mut together, mut alone) = (start.clone(), start.clone());
                    let mut points = Vec::new();
                    with_lanes!(level, simd => draw_points(simd, &mut together, &mut points));
                    let expected: Vec<_> = alone.iter_mut().map(Sampler::next_2d).collect();
                    assert_eq!((points, together), (expected, alone), "{kind:?} {level:?}");
                }
            }
        }
    }

    #[test]
    fn lanes_tell_kinds_apart() {
        let mut mixed = streams(SamplerKind::Sobol, 4, 0);
        mixed[3] = streams(SamplerKind::Halton, 4, 0)[3];
        compare(&mixed, &(0..MAX_LANES).collect::<Vec<_>>());
    }
}
