//! The particle contract: light traced from the emitters to the sensor.

use crate::watch::Watch;
use etendue_sampling::Sampler;
use etendue_scene::Scene;
use etendue_scene::sensor::Sensor;
use etendue_spectrum::Spectrum;
use glam::Vec2;

/// Traces particles from the emitters. Each particle leaves splats on the film wherever the sensor
/// sees its path.
///
/// # Contract
/// - There is one particle for every camera sample. It is a pure function of the scene, the sensor
///   and the random numbers of its [`Sampler`].
/// - The sampler is a copy of the camera sample's. A bidirectional integrator can therefore trace
///   the same light path in both calls: once to connect it to the camera path, once to connect it
///   to the sensor.
/// - The work is bounded, and the [`Watch`] may abandon it, as for camera samples.
/// - The mean of the splats over all particles is added to the picture of the camera samples.
pub trait ParticleIntegrator: Send + Sync {
    /// Traces one particle through the scene and sends its splats to `sink`.
    fn trace_particle(
        &self,
        scene: &Scene,
        sampler: &mut Sampler,
        target: &SplatTarget<'_>,
        sink: &mut SplatSink<'_>,
        watch: &Watch<'_>,
    );
}

/// The target of splats: the film as its sensor sees the scene.
#[derive(Clone, Copy, Debug)]
pub struct SplatTarget<'a> {
    /// The sensor.
    pub sensor: &'a Sensor,
    /// How far beyond the film's edges a splat still counts, as a fraction of the film's size: the
    /// reach of the reconstruction filter.
    pub margin: Vec2,
}

impl SplatTarget<'_> {
    /// Whether a splat at this position counts.
    #[must_use]
    pub fn contains(&self, film_position: Vec2) -> bool {
        let beyond = (film_position - 0.5).abs() - 0.5;
        beyond.cmplt(self.margin).all()
    }
}

/// A contribution to one position of the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// The position; the whole film is [0, 1)².
    pub film_position: Vec2,
    /// Its contribution to the film's mean radiance.
    pub color: Spectrum,
}

/// Receives the splats of a particle.
pub type SplatSink<'a> = dyn FnMut(Splat) + 'a;
