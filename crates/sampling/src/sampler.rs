//! The random numbers of one camera sample, as a function of seed, pixel, sample index, dimension.
//!
//! No generator carries state from one sample to the next. A picture therefore does not depend on
//! threads, tiles or passes, and any sample can be had again.

mod halton;
mod hammersley;
mod lanes;
mod low_discrepancy;
mod multijitter;
mod orthogonal;
mod sobol;
mod stratified;

use crate::hash::{GOLDEN, ONE_MINUS_EPSILON, mix64, unit_float};
use etendue_math::lanes::{Vector2, Word32, Word64};
use glam::{UVec2, Vec2};

pub use lanes::{RandomBatch, draw_points, draw_vertices};

/// The greatest planned number of samples per pixel; larger plans are cut to it.
const MAX_PLANNED: u32 = 1 << 30;

/// How the samples of one pixel are spread.
///
/// The kinds that plan for a number n of samples start over with a fresh, independent set of n for
/// every n samples beyond the plan: the estimate stays unbiased, and its error then falls as that of
/// independent samples. The others (independent, Halton, Sobol') are sequences without an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SamplerKind {
    /// No pattern: every number is a hash of its place.
    Independent,
    /// A grid of k × k strata per pair of dimensions, in shuffled order, with a random point in each.
    Stratified,
    /// Correlated multi-jittering (Kensler, 2013): a grid of strata whose projections are stratified
    /// as finely as there are samples.
    Multijitter,
    /// Orthogonal array sampling of strength two (Jarosz et al., 2019; Bose's construction): every
    /// pair out of p + 1 dimensions is stratified p × p, and every dimension into p² parts.
    Orthogonal,
    /// The first blocks of the (0, 2)-sequence in base 2, shuffled and digit-scrambled per pair of
    /// dimensions (Kollig and Keller, *Efficient Multidimensional Sampling*, 2002).
    LowDiscrepancy,
    /// Halton's sequence with Owen-scrambled digits.
    Halton,
    /// Hammersley's set per pair of dimensions: index / n, jittered, and the scrambled radical
    /// inverse of the index.
    Hammersley,
    /// Sobol's first two dimensions per pair, shuffled and Owen-scrambled by hashes (Burley, 2020).
    Sobol,
}

/// The plan of a pixel's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplerSpec {
    kind: SamplerKind,
    seed: u64,
    sets: SampleSets,
}

/// The finite sets that a planned kind divides its samples into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct SampleSets {
    /// Samples per set.
    count: u32,
    /// Columns of the strata: for orthogonal arrays the prime.
    columns: u32,
    /// Rows of the strata.
    rows: u32,
}

impl SamplerSpec {
    /// A plan for `samples_per_pixel` samples, rounded up as the kind needs: to a square
    /// (stratified), a product (multi-jittered), a prime's square (orthogonal), or a power of two
    /// (low discrepancy). Zero counts as one, and more than 2³⁰ as 2³⁰ before rounding.
    #[must_use]
    pub fn new(kind: SamplerKind, samples_per_pixel: u32, seed: u64) -> Self {
        let planned = samples_per_pixel.clamp(1, MAX_PLANNED);
        let (columns, rows) = match kind {
            SamplerKind::Stratified => stratified::grid(planned),
            SamplerKind::Multijitter => multijitter::grid(planned),
            SamplerKind::Orthogonal => orthogonal::grid(planned),
            SamplerKind::LowDiscrepancy => (planned.next_power_of_two(), 1),
            _ => (planned, 1),
        };
        Self { kind, seed, sets: SampleSets { count: columns * rows, columns, rows } }
    }

    /// The kind asked for.
    #[must_use]
    pub fn kind(&self) -> SamplerKind {
        self.kind
    }

    /// The seed asked for.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The number of samples per pixel that completes the pattern, at least the number planned.
    #[must_use]
    pub fn rounded_sample_count(&self) -> u32 {
        self.sets.count
    }

    /// The random numbers of sample `sample_index` of `pixel`, from dimension 0 on.
    #[inline]
    #[must_use]
    pub fn start(&self, pixel: UVec2, sample_index: u32) -> Sampler {
        self.pixel(pixel).start(sample_index)
    }

    /// What the random numbers of all samples of a pixel have in common.
    #[inline]
    #[must_use]
    pub fn pixel(&self, pixel: UVec2) -> PixelSampler {
        let place = u64::from(pixel.x) | u64::from(pixel.y) << 32;
        let seed = mix64(mix64(self.seed.wrapping_add(GOLDEN)).wrapping_add(place));
        PixelSampler { spec: *self, seed, first_set_seed: mix64(seed) }
    }
}

/// The random numbers of one pixel; made by [`SamplerSpec::pixel`].
#[derive(Clone, Copy, Debug)]
pub struct PixelSampler {
    spec: SamplerSpec,
    /// A hash of seed and pixel.
    seed: u64,
    /// A hash of that and the first set.
    first_set_seed: u64,
}

impl PixelSampler {
    /// The random numbers of sample `sample_index`, from dimension 0 on.
    #[inline]
    #[must_use]
    pub fn start(&self, sample_index: u32) -> Sampler {
        let SamplerSpec { kind, sets, .. } = self.spec;
        let (set, index) = match kind {
            SamplerKind::Independent | SamplerKind::Halton => (0, sample_index),
            // Every use of the index starts from its reversed bits.
            SamplerKind::Sobol => (0, sample_index.reverse_bits()),
            _ => (sample_index / sets.count, sample_index % sets.count),
        };
        let set_seed = match set {
            0 => self.first_set_seed,
            _ => mix64(self.seed ^ u64::from(set).wrapping_mul(GOLDEN)),
        };
        let sample_seed = mix64((!set_seed).wrapping_add(u64::from(index).wrapping_mul(GOLDEN)));
        Sampler { kind, dimension: 0, index, sets, set_seed, sample_seed }
    }
}

/// The random numbers of one sample of one pixel; made by [`SamplerSpec::start`].
///
/// A copy continues on its own with the same numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    kind: SamplerKind,
    dimension: u32,
    /// The index of the sample in its set; with its bits reversed for Sobol'.
    index: u32,
    sets: SampleSets,
    /// A hash of seed, pixel and set.
    set_seed: u64,
    /// A hash of seed, pixel, set and sample.
    sample_seed: u64,
}

/// Dimensions from here on are independent in every kind: film, lens and two vertices of six
/// numbers each come before. What a path does later is no smooth function of the numbers any more,
/// so that spreading them gains nothing, and a spread pair costs four times as much to draw.
const SPREAD_DIMENSIONS: u32 = 16;

impl Sampler {
    /// The next number, uniform in [0, 1). Takes one dimension.
    #[inline]
    #[must_use]
    pub fn next_1d(&mut self) -> f32 {
        let value = match self.kind {
            _ if self.is_independent() => unit_float((self.jitter() >> 32) as u32),
            SamplerKind::Independent | SamplerKind::Sobol => sobol::next_1d(self),
            SamplerKind::LowDiscrepancy => low_discrepancy::next_1d(self),
            SamplerKind::Halton => halton::next_1d(self),
            SamplerKind::Orthogonal => orthogonal::next_1d(self),
            SamplerKind::Stratified | SamplerKind::Multijitter | SamplerKind::Hammersley => {
                stratified::next_1d(self)
            }
        };
        self.dimension = self.dimension.wrapping_add(1);
        value
    }

    /// The next point, uniform in [0, 1)². Takes two dimensions (and where an orthogonal array has a
    /// single column left, that one too).
    #[inline]
    #[must_use]
    pub fn next_2d(&mut self) -> Vec2 {
        let value = match self.kind {
            _ if self.is_independent() => return self.next_independent_2d(),
            SamplerKind::Independent | SamplerKind::Sobol => sobol::next_2d(self),
            SamplerKind::LowDiscrepancy => low_discrepancy::next_2d(self),
            SamplerKind::Stratified => stratified::next_2d(self),
            SamplerKind::Multijitter => multijitter::next_2d(self),
            SamplerKind::Hammersley => hammersley::next_2d(self),
            SamplerKind::Halton => halton::next_2d(self),
            SamplerKind::Orthogonal => orthogonal::next_2d(self),
        };
        self.dimension = self.dimension.wrapping_add(2);
        value
    }

    /// The next point, without regard to the other samples: for decisions that gain nothing from
    /// being spread, at a quarter of the cost. Takes two dimensions.
    #[inline]
    #[must_use]
    pub fn next_independent_2d(&mut self) -> Vec2 {
        let bits = self.jitter();
        self.dimension = self.dimension.wrapping_add(2);
        point_of_bits(bits).into()
    }

    /// The dimension that the next number is taken from.
    #[inline]
    #[must_use]
    pub fn dimension(&self) -> u32 {
        self.dimension
    }

    /// Goes to a dimension, forward or back: the numbers that follow depend on it alone.
    #[inline]
    pub fn set_dimension(&mut self, dimension: u32) {
        self.dimension = dimension;
    }

    /// Whether the next number is drawn without regard to the other samples.
    #[inline]
    fn is_independent(&self) -> bool {
        is_independent(self.kind, self.dimension)
    }

    /// 64 bits that no other dimension, sample, pixel or seed shares.
    #[inline]
    fn jitter(&self) -> u64 {
        bits_of_dimension(self.sample_seed, self.dimension)
    }

    /// Two seeds that the samples of this set have in common at this dimension.
    #[inline]
    fn set_seeds(&self) -> (u32, u32) {
        let bits = self.set_bits();
        (bits.upper(), bits.lower())
    }

    /// These seeds, the first in the upper half.
    #[inline]
    fn set_bits(&self) -> u64 {
        bits_of_dimension(self.set_seed, self.dimension)
    }
}

/// Whether numbers of this dimension are drawn without regard to the other samples.
#[inline(always)]
fn is_independent(kind: SamplerKind, dimension: u32) -> bool {
    dimension >= SPREAD_DIMENSIONS || kind == SamplerKind::Independent
}

/// 64 bits for a dimension of a seed.
#[inline(always)]
fn bits_of_dimension<W: Word64>(seed: W, dimension: u32) -> W {
    mix64(seed.plus(u64::from(dimension).wrapping_mul(GOLDEN)))
}

/// A point from 64 bits.
#[inline(always)]
fn point_of_bits<W: Word64>(bits: W) -> Vector2<<W::Half as Word32>::Real> {
    Vector2::new(unit_float(bits.upper()), unit_float(bits.lower()))
}

/// A third seed from two: the upper half of a product depends on all of their bits.
#[inline(always)]
fn next_seed<W: Word64>(seeds: W) -> W::Half {
    seeds.times(0xd134_2543_de82_ef95).upper()
}

/// The number at share `offset` of stratum `stratum` out of `count`; rounding never reaches one.
#[inline]
fn in_stratum(stratum: u32, offset: f32, count: u32) -> f32 {
    // In double precision, as there may be more strata than single precision has digits for.
    let value = (f64::from(stratum) + f64::from(offset)) / f64::from(count);
    (value as f32).min(ONE_MINUS_EPSILON)
}

#[cfg(test)]
mod tests;
