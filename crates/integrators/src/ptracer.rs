//! `ptracer`: particles from the emitters, whose splats make the picture.

use crate::estimator::{HideEmitters, PathVertex, Roulette, emitted, first_hit, first_surface};
use crate::integrator::{Integrator, Radiance, Start};
use crate::parameters::{DepthLimits, HIDE_EMITTERS, MAX_DEPTH, RR_DEPTH, read_hide_emitters};
use crate::particles::{ParticleIntegrator, Splat, SplatSink, SplatTarget};
use crate::watch::{Watch, WorkLimit};
use etendue_document::Parameters;
use etendue_math::Ray;
use etendue_sampling::Sampler;
use etendue_scene::bsdf::{Bsdf, Lobe, Transport};
use etendue_scene::sensor::Connection;
use etendue_scene::{Manual, ParameterManual, Scene, SurfaceInteraction};
use etendue_spectrum::Spectrum;
use glam::Vec2;

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "Light tracing: particles start at the emitters and are scattered through the scene; whatever \
              they meet is connected with the camera. Good where light takes a narrow way out, such as \
              caustics; bad where the camera sees little of what is lit, and blind where it looks into a \
              mirror. Emitters that are seen directly are left to camera rays. For every sample of a pixel \
              there is one particle. Sensors: `perspective`, `thinlens` and `orthographic`.",
    parameters: &[
        MAX_DEPTH,
        RR_DEPTH,
        HIDE_EMITTERS,
        ParameterManual {
            name: "samples_per_pass",
            kind: "integer",
            default: "",
            meaning: "Accepted and without effect: passes follow the clock.",
        },
    ],
    sample: r#"<integrator type="ptracer"><integer name="max_depth" value="8"/></integrator>"#,
};

/// The particle tracer.
#[derive(Clone, Debug)]
pub struct ParticleTracer {
    limits: DepthLimits,
    hide_emitters: HideEmitters,
}

/// The fraction of a connection's length that must be free. The rest allows for rounding of the
/// distance, so that the lens does not block it.
const CONNECTION_LENGTH: f32 = 1.0 - 2e-5;

/// A particle between two vertices of its path.
struct Particle {
    ray: Ray,
    /// The power that it carries.
    power: Spectrum,
    /// The largest component of its initial power, for roulette.
    start: f32,
    /// The index of refraction here, relative to that at the emitter.
    eta: f32,
}

/// A surface hit of a particle's path.
struct Vertex<'a> {
    surface: &'a SurfaceInteraction,
    bsdf: &'a Bsdf<'a>,
}

impl ParticleTracer {
    /// Builds a particle tracer from its parameters.
    #[must_use]
    pub fn build(parameters: &Parameters<'_>) -> Self {
        parameters.optional_integer("samples_per_pass");
        Self {
            limits: DepthLimits::read(parameters),
            hide_emitters: read_hide_emitters(parameters),
        }
    }

    /// Starts a particle at an emitter; `None` if the emitter's sample fails.
    fn emit(scene: &Scene, sampler: &mut Sampler) -> Option<Particle> {
        let mut choice_random = sampler.next_1d();
        let (place, direction) = (sampler.next_2d(), sampler.next_2d());
        let choice = scene.choose_emitter(&mut choice_random)?;
        let leaving = scene.emitter(choice.emitter).sample_ray(scene, place, direction)?;
        let power = leaving.power / choice.probability;
        Some(Particle { ray: leaving.ray, power, start: power.max_component(), eta: 1.0 })
    }

    /// Connects a vertex of a particle's path to the camera.
    fn connect(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        particle: &Particle,
        connection: &Connection,
    ) -> Spectrum {
        let Vertex { surface, bsdf } = vertex;
        let hidden = self.hide_emitters.hides(scene, surface);
        if hidden || !bsdf.has_smooth_lobe() {
            return Spectrum::ZERO;
        }
        let wo = surface.to_local(connection.direction);
        let (value, _) = bsdf.eval_pdf(surface.wi, wo, Transport::Importance);
        let scale = shading_correction(surface, particle.ray.direction, connection.direction)
            * connection.importance;
        let color = particle.power * value * scale;
        if color.is_black() || !color.is_finite() || self.is_blocked(scene, surface, connection) {
            return Spectrum::ZERO;
        }
        color
    }

    /// Whether the line from a surface to the camera is blocked.
    fn is_blocked(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        connection: &Connection,
    ) -> bool {
        let mut ray = surface.spawn_ray(connection.direction);
        ray.t_max = connection.distance * CONNECTION_LENGTH;
        if !self.hide_emitters.0 {
            return scene.occluded(&ray);
        }
        first_hit(scene, &ray, self.hide_emitters).is_some()
    }

    /// Scatters a particle at a vertex; false if its path ends.
    fn scatter(
        &self,
        vertex: &Vertex<'_>,
        particle: &mut Particle,
        sampler: &mut Sampler,
        depth: u32,
    ) -> bool {
        let Vertex { surface, bsdf } = vertex;
        let direction = sampler.next_2d();
        let Vec2 { x: lobe, y: roulette } = sampler.next_independent_2d();
        let Some(sample) = bsdf.sample(surface.wi, lobe, direction, Transport::Importance) else {
            return false;
        };
        let direction = surface.to_world(sample.wo);
        let correction = match sample.lobe {
            Lobe::Null => 1.0,
            _ => shading_correction(surface, particle.ray.direction, direction),
        };
        particle.power *= sample.weight * correction;
        particle.eta *= sample.eta;
        particle.ray = surface.spawn_ray(direction);
        if particle.power.is_black() || !particle.power.is_finite() {
            return false;
        }
        if depth >= self.limits.rr_depth {
            let share = particle.power.max_component() / particle.start;
            let Roulette { survives, gain } = Roulette::play(share, particle.eta, roulette);
            particle.power *= gain;
            return survives;
        }
        true
    }
}

/// The shading normal correction for light traced from its source: |wi·Ns| |wo·Ng| / (|wi·Ng|
/// |wo·Ns|), where wi points towards the particle's origin (Veach, *Robust Monte Carlo Methods for
/// Light Transport Simulation*, 1997, section 5.3).
fn shading_correction(
    surface: &SurfaceInteraction,
    travelled: glam::Vec3,
    outgoing: glam::Vec3,
) -> f32 {
    let shading = surface.shading.n;
    let above = travelled.dot(shading) * outgoing.dot(surface.normal);
    let below = travelled.dot(surface.normal) * outgoing.dot(shading);
    (above / below).abs()
}

impl Integrator for ParticleTracer {
    /// The emitters that the camera sees directly. Particles contribute the rest.
    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        _: &mut Sampler,
        _: &mut [f32],
        _: &Watch<'_>,
    ) -> Radiance {
        let ray = &start.ray;
        let camera = PathVertex::camera(ray.origin);
        let radiance = first_surface(scene, ray, self.hide_emitters).map_or_else(
            |background| background,
            |surface| Radiance {
                color: emitted(scene, &surface, ray.direction, &camera),
                alpha: 1.0,
            },
        );
        if self.limits.max_depth > 0 {
            radiance
        } else {
            Radiance { color: Spectrum::ZERO, ..radiance }
        }
    }

    fn particles(&self) -> Option<&dyn ParticleIntegrator> {
        Some(self)
    }
}

impl ParticleIntegrator for ParticleTracer {
    fn trace_particle(
        &self,
        scene: &Scene,
        sampler: &mut Sampler,
        target: &SplatTarget<'_>,
        sink: &mut SplatSink<'_>,
        watch: &Watch<'_>,
    ) {
        let Some(mut particle) = Self::emit(scene, sampler) else { return };
        let mut edges = WorkLimit::edges(watch);
        // The last edge leads to the camera.
        let mut depth = 1;
        while depth < self.limits.max_depth && edges.step() {
            let Some(surface) = scene.intersect(&particle.ray) else { return };
            let bsdf = scene.prepare_bsdf(&surface);
            let vertex = Vertex { surface: &surface, bsdf: &bsdf };
            let connection = target.sensor.connect(surface.point, sampler.next_2d());
            let connection = connection.filter(|found| target.contains(found.film_position));
            if let Some(connection) = connection {
                let color = self.connect(scene, &vertex, &particle, &connection);
                if !color.is_black() {
                    sink(Splat { film_position: connection.film_position, color });
                }
            }
            if !self.scatter(&vertex, &mut particle, sampler, depth) {
                return;
            }
            depth += 1;
        }
    }
}
