//! The contract of an integrator: the light that arrives along a camera ray, and what there may be to
//! learn before.

use crate::particles::ParticleIntegrator;
use etendue_math::Ray;
use etendue_sampling::Sampler;
use etendue_scene::{MediumId, Scene};
use etendue_spectrum::Spectrum;

/// A way to compute light.
///
/// An integrator knows rays, light and random numbers; it knows no pixels. Who renders chooses the
/// rays, weighs what arrives, and adds it up.
///
/// # Contract
/// - A camera sample is a pure function of the scene, the ray and the random numbers of its
///   [`Sampler`]. Nothing is kept from one sample to the next.
/// - The expected value is the radiance along the ray. Where [`Self::particles`] is not `None`, the
///   mean of their splats is added to it: the two together have the right expected value.
/// - Results that are not finite are the caller's to count and to leave out.
pub trait Integrator: Send + Sync {
    /// The names of the channels beside colour and alpha, such as `albedo.R`, in the order of their
    /// values in [`Self::sample`].
    fn channels(&self) -> &[String] {
        &[]
    }

    /// What arrives along the ray that starts at `start`. `channels` has one value for each of
    /// [`Self::channels`], all zero.
    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        sampler: &mut Sampler,
        channels: &mut [f32],
    ) -> Radiance;

    /// Takes many samples, each equal to that of [`Self::sample`] to the bit, and appends them to
    /// `radiance`. `channels` has the values of all rays, ray after ray.
    fn sample_batch(
        &self,
        scene: &Scene,
        rays: &mut [CameraRay],
        channels: &mut [f32],
        radiance: &mut Vec<Radiance>,
    ) {
        let channel_count = self.channels().len();
        radiance.extend(rays.iter_mut().enumerate().map(
            |(index, CameraRay { start, sampler })| {
                let channels = &mut channels[index * channel_count..(index + 1) * channel_count];
                self.sample(scene, start, sampler, channels)
            },
        ));
    }

    /// The particles that bring the rest of the light, if any do. Integrators that nest others, such as
    /// `aov`, leave out their particles, and say so when they are built.
    fn particles(&self) -> Option<&dyn ParticleIntegrator> {
        None
    }

    /// What there is to learn before the first sample of the picture, if anything is.
    fn training(&self) -> Option<Box<dyn Training>> {
        None
    }
}

/// Learns from camera samples, pass by pass, and becomes the integrator that renders the picture.
///
/// Every pass takes samples over the whole film with what the passes before it have learned, and
/// sums up what they show. Between passes, [`Self::refine`] turns the sums into what the next pass
/// uses. The samples of a training are not part of the picture.
///
/// # Contract
/// - The result is a function of the scene, the sensor, the sampler and the integrator, bit for bit.
///   It does not depend on threads, on the part of the film that is rendered, or on which of its
///   samples are. Every part of a divided render and every resumed run repeats the same training, so
///   checkpoints stay valid and parts may be merged.
/// - [`Self::learn`] runs on many threads at once, with any division of a pass into batches. Its
///   sums must not depend on the order of what is added: they are integers, atomic or behind a lock.
pub trait Training: Send + Sync {
    /// How many samples each pass gives every pixel. It does not change while training goes on.
    fn samples_of_passes(&self) -> &[u32];

    /// Takes camera samples with what earlier passes have learned, and adds up what they show.
    fn learn(&self, scene: &Scene, rays: &mut [CameraRay]);

    /// Ends a pass: turns its sums into what later samples use.
    fn refine(&mut self);

    /// Ends the training; the integrator has no training left.
    fn finish(self: Box<Self>) -> Box<dyn Integrator>;
}

/// What one camera sample sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radiance {
    /// Radiance, linear Rec.709.
    pub color: Spectrum,
    /// 1 where the ray meets something, 0 where the background shows.
    pub alpha: f32,
}

impl Radiance {
    /// No light, and only background.
    pub const NONE: Self = Self { color: Spectrum::ZERO, alpha: 0.0 };
}

/// Where a camera sample starts.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The ray; its direction is unit.
    pub ray: Ray,
    /// The medium around its origin.
    pub medium: Option<MediumId>,
}

/// A camera sample before it is taken.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// Where it starts.
    pub start: Start,
    /// Its random numbers; those that chose the ray have been drawn.
    pub sampler: Sampler,
}
