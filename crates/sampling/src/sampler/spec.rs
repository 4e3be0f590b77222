//! The plan of a pixel's samples, from which samplers start.

use super::kind::{SampleSets, SamplerKind};
use super::state::Sampler;
use super::{multijitter, orthogonal, stratified};
use crate::hash::{GOLDEN, mix64};
use glam::UVec2;

/// The greatest planned number of samples per pixel; larger plans are cut to it.
const MAX_PLANNED: u32 = 1 << 30;

/// The plan of a pixel's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplerSpec {
    kind: SamplerKind,
    seed: u64,
    /// How many independent sequences take turns in giving a pixel its samples.
    sequences: u32,
    pub(super) sets: SampleSets,
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
        let sets = SampleSets { count: columns * rows, columns, rows };
        Self { kind, seed, sequences: 1, sets }
    }

    /// A plan whose samples with even and with odd index come from two independent sequences, each
    /// planned for half of the samples. From the difference of their means follows the variance of
    /// the pixel, which the samples of a single sequence cannot tell, because they depend on each
    /// other.
    ///
    /// Independent samples need no second sequence: they are those of [`Self::new`].
    #[must_use]
    pub fn in_halves(kind: SamplerKind, samples_per_pixel: u32, seed: u64) -> Self {
        match kind {
            SamplerKind::Independent => Self::new(kind, samples_per_pixel, seed),
            _ => Self { sequences: 2, ..Self::new(kind, samples_per_pixel.div_ceil(2), seed) },
        }
    }

    /// How the samples are spread.
    #[must_use]
    pub fn kind(&self) -> SamplerKind {
        self.kind
    }

    /// The seed. Plans with different seeds give independent numbers.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The number of samples per pixel that completes the pattern, at least the number planned.
    #[must_use]
    pub fn rounded_sample_count(&self) -> u32 {
        self.sets.count.saturating_mul(self.sequences)
    }

    /// The sampler of sample `sample_index` of `pixel`, at dimension 0.
    #[inline]
    #[must_use]
    pub fn start(&self, pixel: UVec2, sample_index: u32) -> Sampler {
        self.pixel(pixel).start(sample_index)
    }

    /// The samplers of a pixel. They share some of the work.
    #[inline]
    #[must_use]
    pub fn pixel(&self, pixel: UVec2) -> PixelSampler {
        let place = u64::from(pixel.x) | u64::from(pixel.y) << 32;
        let seed = mix64(mix64(self.seed.wrapping_add(GOLDEN)).wrapping_add(place));
        PixelSampler { spec: *self, seed, first_set_seed: mix64(seed) }
    }
}

/// Starts the samplers of one pixel; made by [`SamplerSpec::pixel`].
#[derive(Clone, Copy, Debug)]
pub struct PixelSampler {
    spec: SamplerSpec,
    /// A hash of seed and pixel.
    seed: u64,
    /// A hash of that and the first set.
    first_set_seed: u64,
}

impl PixelSampler {
    /// The sampler of sample `sample_index`, at dimension 0.
    #[inline]
    #[must_use]
    pub fn start(&self, sample_index: u32) -> Sampler {
        match self.spec.sequences {
            1 => self.start_in_sequence(sample_index),
            count => {
                let sequence = self.of_sequence(sample_index % count);
                sequence.start_in_sequence(sample_index / count)
            }
        }
    }

    #[inline]
    fn start_in_sequence(&self, sample_index: u32) -> Sampler {
        let SamplerSpec { kind, sets, .. } = self.spec;
        let (set, index) = match kind {
            SamplerKind::Independent | SamplerKind::Halton => (0, sample_index),
            // Sobol' points are computed from the reversed bits of the index.
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

    /// The same with the seed of one of several sequences.
    #[inline]
    fn of_sequence(&self, sequence: u32) -> Self {
        let seed = mix64(self.seed ^ ((u64::from(sequence) + 1) << 32));
        Self { seed, first_set_seed: mix64(seed), ..*self }
    }
}
