//! The random numbers of several paths at once, each with the bits of [`Sampler`]'s methods.

use super::kind::SamplerKind;
use super::sobol;
use super::state::{Sampler, bits_of_dimension, is_independent, point_of_bits};
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

/// The parts of several samplers that differ from one to the next.
#[derive(Default)]
struct Seeds {
    indices: WordArray32,
    sets: WordArray64,
    samples: WordArray64,
}

/// The parts of several samplers that must be equal to draw in lanes.
#[derive(Clone, Copy)]
struct Place {
    kind: SamplerKind,
    dimension: u32,
}

/// Draws the numbers of a vertex for the paths with the indices `chosen`, each at most once, the first
/// in the first lane. Paths beyond [`MAX_LANES`] are left out. `sampler_of` finds a path's sampler.
///
/// Every sampler draws as by `next_2d`, `next_2d` and `next_independent_2d` in this order, and is left
/// at the same dimension. Lanes without a path hold any number below one.
#[inline(always)]
pub fn draw_vertices<S: Simd, P>(
    simd: S,
    paths: &mut [P],
    chosen: impl Iterator<Item = usize> + Clone,
    sampler_of: impl Fn(&mut P) -> &mut Sampler,
    numbers: &mut RandomBatch,
) {
    let Some(path) = chosen.clone().next() else { return };
    let place = Place::of(sampler_of(&mut paths[path]));
    let mut seeds = Seeds::default();
    let (mut count, mut difference) = (0, 0);
    for (lane, path) in chosen.clone().take(MAX_LANES).enumerate() {
        let sampler = sampler_of(&mut paths[path]);
        difference |= place.difference(Place::of(sampler));
        seeds.set(lane, sampler);
        sampler.dimension = sampler.dimension.wrapping_add(VERTEX_DIMENSIONS);
        count = lane + 1;
    }
    if difference == 0 && place.has_lanes() && place.after(2).has_lanes() {
        for first in (0..count).step_by(Lanes::<S>::COUNT) {
            seeds.draw(simd, place, first, numbers);
        }
        return;
    }
    for (lane, path) in chosen.take(MAX_LANES).enumerate() {
        let sampler = sampler_of(&mut paths[path]);
        sampler.dimension = sampler.dimension.wrapping_sub(VERTEX_DIMENSIONS);
        draw_alone(sampler, numbers, lane);
    }
}

/// Draws `next_2d` of each sampler, in order, and appends the points. It is fastest where all samplers
/// are at the same dimension.
#[inline(always)]
pub fn draw_points<S: Simd>(simd: S, samplers: &mut [Sampler], points: &mut Vec<Vec2>) {
    for chunk in samplers.chunks_mut(MAX_LANES) {
        let place = Place::of(&chunk[0]);
        if !place.has_lanes()
            || chunk.iter().any(|sampler| place.difference(Place::of(sampler)) != 0)
        {
            points.extend(chunk.iter_mut().map(Sampler::next_2d));
            continue;
        }
        let mut seeds = Seeds::default();
        for (lane, sampler) in chunk.iter_mut().enumerate() {
            seeds.set(lane, sampler);
            sampler.dimension = place.after(2).dimension;
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
    fn of(sampler: &Sampler) -> Self {
        Self { kind: sampler.kind, dimension: sampler.dimension }
    }

    /// Zero if the two are the same. It has no branch, as it runs for every path.
    #[inline(always)]
    fn difference(self, other: Self) -> u32 {
        (self.kind as u32 ^ other.kind as u32) | (self.dimension ^ other.dimension)
    }

    /// The place so many dimensions later.
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
    fn set(&mut self, lane: usize, sampler: &Sampler) {
        self.indices.0[lane] = sampler.index;
        self.sets.0[lane] = sampler.set_seed;
        self.samples.0[lane] = sampler.sample_seed;
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
fn draw_alone(sampler: &mut Sampler, numbers: &mut RandomBatch, lane: usize) {
    Vector2::from(sampler.next_2d()).put(&mut numbers.light, lane);
    Vector2::from(sampler.next_2d()).put(&mut numbers.direction, lane);
    Vector2::from(sampler.next_independent_2d()).put(&mut numbers.choices, lane);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::spec::SamplerSpec;
    use etendue_math::lanes::{Level, baseline};
    use etendue_math::with_lanes;
    use glam::UVec2;

    /// Samplers at `dimension`; every fifth is `others` dimensions further.
    fn samplers(kind: SamplerKind, dimension: u32, others: u32) -> Vec<Sampler> {
        let spec = SamplerSpec::new(kind, 9, 3);
        (0..40_u32)
            .map(|number| {
                let mut sampler = spec.start(UVec2::new(number % 7, number), number * number);
                let moved = if number.is_multiple_of(5) { others } else { 0 };
                sampler.set_dimension(dimension.wrapping_add(moved));
                sampler
            })
            .collect()
    }

    /// Draws in lanes and one by one, and compares the numbers and the samplers afterwards.
    fn compare(start: &[Sampler], chosen: &[usize]) {
        for level in [baseline(), Level::new()] {
            let (mut together, mut alone) = (start.to_vec(), start.to_vec());
            let mut batch = RandomBatch::default();
            with_lanes!(level, simd => {
                let chosen = chosen.iter().copied();
                draw_vertices(simd, &mut together, chosen, |sampler| sampler, &mut batch);
            });
            let mut expected = RandomBatch::default();
            for (lane, &path) in chosen.iter().take(MAX_LANES).enumerate() {
                draw_alone(&mut alone[path], &mut expected, lane);
            }
            assert_eq!(together, alone, "{level:?}");
            let lanes = chosen.len().min(MAX_LANES);
            let columns = |batch: &RandomBatch| {
                [batch.light, batch.direction, batch.choices]
                    .map(|point| point.map(|column| column.0[..lanes].to_vec()))
            };
            assert_eq!(columns(&batch), columns(&expected), "{level:?}");
        }
    }

    #[test]
    fn lanes_draw_what_single_samplers_draw() {
        for kind in SamplerKind::ALL {
            for dimension in [0, 3, 4, 12, 13, 14, 15, 16, 100, u32::MAX - 3, u32::MAX - 1] {
                for others in [0, 6] {
                    let start = samplers(kind, dimension, others);
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
    fn points_are_those_of_single_samplers() {
        for kind in SamplerKind::ALL {
            for (dimension, others) in [(0, 0), (3, 0), (15, 0), (16, 0), (4, 6)] {
                let start = samplers(kind, dimension, others);
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
        let mut mixed = samplers(SamplerKind::Sobol, 4, 0);
        mixed[3] = samplers(SamplerKind::Halton, 4, 0)[3];
        compare(&mixed, &(0..MAX_LANES).collect::<Vec<_>>());
    }
}
