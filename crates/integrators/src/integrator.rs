//! The integrator contract: the light that arrives along a camera ray, and training before the
//! render.

use crate::particles::ParticleIntegrator;
use crate::watch::Watch;
use etendue_math::Ray;
use etendue_sampling::Sampler;
use etendue_scene::{MediumId, Scene};
use etendue_spectrum::Spectrum;

/// A light transport algorithm.
///
/// An integrator knows rays, light and random numbers, but not pixels. The caller generates the
/// rays and accumulates the weighted results.
///
/// # Contract
/// - A camera sample is a pure function of the scene, the ray and the random numbers of its
///   [`Sampler`]. No state is kept between samples.
/// - The work for a sample is bounded, and long work asks the [`Watch`] whether to go on. If the
///   watch abandons a batch, its results are meaningless.
/// - The expected value is the radiance along the ray. If [`Self::particles`] is not `None`, the
///   mean of their splats is added: only the sum of both has the right expected value.
/// - The caller counts and discards results that are not finite.
pub trait Integrator: Send + Sync {
    /// The names of the channels besides colour and alpha, such as `albedo.R`, in the order of
    /// their values in [`Self::sample`].
    fn channels(&self) -> &[String] {
        &[]
    }

    /// How the film combines the values of each of [`Self::channels`].
    fn channel_kinds(&self) -> Vec<ChannelKind> {
        vec![ChannelKind::Mean; self.channels().len()]
    }

    /// The radiance and alpha along the ray that starts at `start`. `channels` has one value for
    /// each of [`Self::channels`], all initially zero.
    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        sampler: &mut Sampler,
        channels: &mut [f32],
        watch: &Watch<'_>,
    ) -> Radiance;

    /// Takes many samples, each bit-identical to [`Self::sample`], and appends them to `radiance`.
    /// `channels` has the values of all rays, one row per ray.
    fn sample_batch(
        &self,
        scene: &Scene,
        rays: &mut [CameraRay],
        channels: &mut [f32],
        watch: &Watch<'_>,
        radiance: &mut Vec<Radiance>,
    ) {
        let channel_count = self.channels().len();
        radiance.extend(rays.iter_mut().enumerate().map(
            |(index, CameraRay { start, sampler })| {
                if watch.is_abandoned() {
                    return Radiance::NONE;
                }
                let channels = &mut channels[index * channel_count..(index + 1) * channel_count];
                self.sample(scene, start, sampler, channels, watch)
            },
        ));
    }

    /// Whether pictures are black without emitters. False for integrators that render geometry.
    fn needs_light(&self) -> bool {
        true
    }

    /// The limit of indirect light, if any. It makes pictures darker than they should be, so files
    /// tell it.
    fn clamp_indirect(&self) -> Option<f32> {
        None
    }

    /// The particles that bring the rest of the light, if any. Integrators that nest others, such
    /// as `aov`, ignore their particles and warn about it when they are built.
    fn particles(&self) -> Option<&dyn ParticleIntegrator> {
        None
    }

    /// The training before the first sample of the picture, if any.
    fn training(&self) -> Option<Box<dyn Training>> {
        None
    }
}

/// Learns from camera samples, pass by pass, and becomes the integrator that renders the picture.
///
/// Every pass takes samples over the whole film, using what earlier passes have learned, and
/// accumulates statistics. Between passes, [`Self::refine`] turns these into what the next pass
/// uses. Training samples are not part of the picture.
///
/// # Contract
/// - The result is a bit-exact function of the scene, the sensor, the sampler and the integrator.
///   It does not depend on threads, on the rendered region of the film, or on the selected samples.
///   Every part of a divided render and every resumed run repeats the same training, so checkpoints
///   stay valid and parts can be merged.
/// - [`Self::learn`] runs on many threads at once, with any division of a pass into batches. Its
///   sums must not depend on the order of additions: use integers, atomic or behind a lock.
pub trait Training: Send + Sync {
    /// The number of samples per pixel of each pass. It does not change during training.
    fn samples_of_passes(&self) -> &[u32];

    /// Takes camera samples, using what earlier passes have learned, and accumulates statistics.
    fn learn(&self, scene: &Scene, rays: &mut [CameraRay]);

    /// Ends a pass: turns its sums into what later samples use.
    fn refine(&mut self);

    /// Ends the training; the returned integrator has no training left.
    fn finish(self: Box<Self>) -> Box<dyn Integrator>;
}

/// How a film combines the values that a channel has in the samples of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChannelKind {
    /// Their mean, weighted by the reconstruction filter.
    #[default]
    Mean,
    /// The value of the sample nearest to the pixel's centre, for identifiers: their mean would
    /// identify something else.
    Nearest,
}

/// The result of one camera sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radiance {
    /// Radiance, linear Rec.709.
    pub color: Spectrum,
    /// 1 if the ray hits something, 0 if the background shows.
    pub alpha: f32,
}

impl Radiance {
    /// No light and zero alpha.
    pub const NONE: Self = Self { color: Spectrum::ZERO, alpha: 0.0 };
}

/// Where a camera sample starts.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The ray; its direction is a unit vector.
    pub ray: Ray,
    /// The medium around its origin.
    pub medium: Option<MediumId>,
}

/// The input of a camera sample.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// Where it starts.
    pub start: Start,
    /// Its random numbers. Those that chose the ray have already been drawn.
    pub sampler: Sampler,
}
