//! How light is computed: one [`Integrator`] per way.
//!
//! # Contract
//! - A camera sample is a pure function of the scene, the ray and the random numbers of its
//!   [`Sampler`]; nothing is kept from one to the next.
//! - The estimate's expected value is the radiance along the ray. Results that are not finite are
//!   the caller's to count and to leave out.
#![forbid(unsafe_code)]

mod aov;
mod depth;
mod direct;
mod light;
mod media;
mod moment;
mod nested;
mod path;
mod ptracer;
mod registry;
mod thin_sheet;
mod volpath;
mod volpathmis;

pub use aov::Aov;
pub use depth::Depth;
pub use direct::Direct;
pub use moment::Moment;
pub use path::Path;
pub use ptracer::ParticleTracer;
pub use registry::{INTEGRATORS, IntegratorOptions, build_integrator, plugins};
pub use volpath::VolumePath;

use etendue_math::Ray;
use etendue_sampling::Sampler;
use etendue_scene::sensor::Sensor;
use etendue_scene::{MediumId, Scene};
use etendue_spectrum::Spectrum;
use glam::Vec2;

/// What one camera sample sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radiance {
    /// Radiance, linear Rec.709.
    pub color: Spectrum,
    /// 1 where the ray meets something, 0 where the background shows.
    pub alpha: f32,
}

impl Radiance {
    /// Nothing there.
    pub const NONE: Self = Self { color: Spectrum::ZERO, alpha: 0.0 };
}

/// Where a camera sample starts.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The ray; its direction is unit.
    pub ray: Ray,
    /// The medium that its origin lies in.
    pub medium: Option<MediumId>,
}

/// What particles leave their mark on.
#[derive(Clone, Copy, Debug)]
pub struct SplatTarget<'a> {
    /// The sensor.
    pub sensor: &'a Sensor,
    /// How far beyond the film's edges light counts, in sizes of the film: the reconstruction filter
    /// brings it in.
    pub margin: Vec2,
}

impl SplatTarget<'_> {
    /// Whether light at a place on the film counts.
    #[must_use]
    pub fn holds(&self, film_position: Vec2) -> bool {
        let beyond = (film_position - 0.5).abs() - 0.5;
        beyond.cmplt(self.margin).all()
    }
}

/// Takes what a particle leaves on the film: the place on the whole film, which is [0, 1)², and what it
/// adds to the film's mean radiance.
pub type AddSplat<'a> = dyn FnMut(Vec2, Spectrum) + 'a;

/// A camera sample before it is taken.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// Where it starts.
    pub start: Start,
    /// The random numbers that are left.
    pub stream: Sampler,
}

/// A way to compute light.
pub trait Integrator: Send + Sync {
    /// The names of the layers beside the colour, such as `albedo.R`, in the order in which
    /// [`Self::sample`] fills them.
    fn layers(&self) -> &[String] {
        &[]
    }

    /// What arrives along the ray that starts at `start`. `layers` has one place for each of
    /// [`Self::layers`], all zero.
    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        stream: &mut Sampler,
        layers: &mut [f32],
    ) -> Radiance;

    /// As [`Self::sample`] for many rays, with the same results, which are appended to `radiance`.
    /// `layers` has the places of all rays, one after the other.
    fn sample_batch(
        &self,
        scene: &Scene,
        rays: &mut [CameraRay],
        layers: &mut [f32],
        radiance: &mut Vec<Radiance>,
    ) {
        let layer_count = self.layers().len();
        radiance.extend(rays.iter_mut().enumerate().map(|(index, CameraRay { start, stream })| {
            let layers = &mut layers[index * layer_count..(index + 1) * layer_count];
            self.sample(scene, start, stream, layers)
        }));
    }

    /// Whether light comes by [`Self::trace_particle`], too.
    fn traces_particles(&self) -> bool {
        false
    }

    /// Sends one particle from an emitter through the scene, and leaves on the film what its sensor sees
    /// of its path. The mean over particles adds to the picture of [`Self::sample`].
    fn trace_particle(
        &self,
        _scene: &Scene,
        _screen: SplatTarget<'_>,
        _stream: &mut Sampler,
        _deposit: &mut AddSplat<'_>,
    ) {
    }
}
