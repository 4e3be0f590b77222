//! Medium walks: where a path collides next.

use super::weights::{Step, Weights};
use crate::integrator::Start;
use crate::watch::{Watch, WorkLimit};
use etendue_math::Ray;
use etendue_sampling::Sampler;
use etendue_scene::medium::{Collision, Density, Heterogeneous, Homogeneous, Medium, Tracker};
use etendue_scene::phase::MediumInteraction;
use etendue_scene::{Hit, MediumId, Scene, SurfaceInteraction};
use etendue_spectrum::Spectrum;
use glam::Vec3;

/// The next event along a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Event {
    /// It is scattered in a medium.
    Scattering(MediumVertex),
    /// It hits a surface.
    Surface(Hit),
    /// It leaves the scene.
    Escape,
    /// No throughput remains.
    End,
}

/// Where a path is scattered in a medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MediumVertex {
    pub(crate) medium: MediumId,
    pub(crate) point: Vec3,
}

/// A ray and the medium it is in.
#[derive(Clone, Copy)]
pub(crate) struct MediumWalk<'a> {
    pub(crate) ray: Ray,
    pub(crate) medium: Option<MediumId>,
    /// The random numbers for distances. They are separate from those of the vertices, whose
    /// dimensions do not depend on the number of collisions.
    sampler: Sampler,
    /// The colour channel that distances are sampled for.
    channel: usize,
    /// The tentative collisions that the path may still have.
    collisions: WorkLimit<'a>,
}

/// The next tentative collision along a ray.
pub(super) enum Tentative {
    /// The ray may collide here.
    Collision(Collision),
    /// The ray leaves the medium.
    None,
    /// The path has reached its limit.
    TooMany,
}

/// The medium around a ray, with the kind of its density.
#[derive(Clone, Copy)]
struct Passed<'a, D> {
    id: MediumId,
    medium: &'a Medium,
    density: &'a D,
}

/// Vertices use the dimensions below this one, distances those above.
const FIRST_DIMENSION: u32 = 1 << 24;

impl<'a> MediumWalk<'a> {
    pub(crate) fn new(start: &Start, sampler: &Sampler, watch: &'a Watch<'a>) -> Self {
        let mut sampler = *sampler;
        sampler.set_dimension(FIRST_DIMENSION);
        let channels = Spectrum::LANES;
        let channel = ((sampler.next_1d() * channels as f32) as usize).min(channels - 1);
        let collisions = WorkLimit::collisions(watch);
        Self { ray: start.ray, medium: start.medium, sampler, channel, collisions }
    }

    /// Leaves a surface towards `direction`.
    #[inline]
    pub(crate) fn leave(&mut self, scene: &Scene, surface: &SurfaceInteraction, direction: Vec3) {
        self.ray = surface.spawn_ray(direction);
        self.medium = medium_beyond(scene, surface, direction, self.medium);
    }

    /// Moves on to the next event.
    #[inline]
    pub(crate) fn advance(&mut self, scene: &Scene, weights: &mut Weights) -> Event {
        let Some(id) = self.medium else {
            return at_end(scene.closest_hit(&self.ray));
        };
        let medium = scene.medium(id);
        match &medium.density {
            Density::Homogeneous(density) => {
                self.sample_distance(scene, Passed { id, medium, density }, weights)
            }
            Density::Heterogeneous(density) => {
                self.delta_track(scene, Passed { id, medium, density }, weights)
            }
        }
    }

    /// Through a homogeneous medium: the distance to the next collision has a closed form, and
    /// nothing beyond it needs to be intersected.
    fn sample_distance(
        &mut self,
        scene: &Scene,
        passed: Passed<'_, Homogeneous>,
        weights: &mut Weights,
    ) -> Event {
        let Passed { id, medium, density } = passed;
        let start = MediumInteraction { point: self.ray.origin, wi: -self.ray.direction };
        let extinction = density.extinction() * medium.phase.projected_area(&start);
        let t = self.sample_optical_depth() / extinction[self.channel];
        let before = Ray { t_max: t.min(self.ray.t_max), ..self.ray };
        let hit = scene.closest_hit(&before);
        if hit.is_none() && t < self.ray.t_max {
            let transmittance = transmittance(extinction, t);
            let point = self.ray.at(t);
            let value = transmittance * extinction * density.albedo(point);
            let unidirectional_pdf = transmittance * extinction;
            let step = Step { value, unidirectional_pdf, light_pdf: 0.0 };
            return collision(MediumVertex { medium: id, point }, weights, &step);
        }
        let transmittance = transmittance(extinction, hit.map_or(self.ray.t_max, |hit| hit.t));
        // A connection to an emitter would pass with certainty, by the closed form.
        let step = Step { value: transmittance, unidirectional_pdf: transmittance, light_pdf: 1.0 };
        if weights.advance(&step) { at_end(hit) } else { Event::End }
    }

    /// Through a heterogeneous medium: delta tracking.
    fn delta_track(
        &mut self,
        scene: &Scene,
        passed: Passed<'_, Heterogeneous>,
        weights: &mut Weights,
    ) -> Event {
        let Passed { id, medium, density } = passed;
        let hit = scene.closest_hit(&self.ray);
        let t_max = hit.map_or(self.ray.t_max, |hit| hit.t);
        let mut tracker = density.track(&Ray { t_max, ..self.ray });
        loop {
            let found = match self.collide(&mut tracker) {
                Tentative::Collision(found) => found,
                Tentative::None => return at_end(hit),
                Tentative::TooMany => return Event::End,
            };
            let point = self.ray.at(found.t);
            let interaction = MediumInteraction { point, wi: -self.ray.direction };
            let coefficients = medium.coefficients(&interaction);
            // Transmittances of the majorant are equal for all channels and cancel.
            let real = (coefficients.extinction / found.majorant).min(Spectrum::ONE);
            if self.sampler.next_1d() < real[self.channel] {
                let value = coefficients.scattering / found.majorant;
                let step = Step { value, unidirectional_pdf: real, light_pdf: 0.0 };
                return collision(MediumVertex { medium: id, point }, weights, &step);
            }
            let null = Spectrum::ONE - real;
            if !weights.advance(&Step { value: null, unidirectional_pdf: null, light_pdf: 1.0 }) {
                return Event::End;
            }
        }
    }

    /// The next tentative collision.
    #[inline]
    pub(super) fn collide(&mut self, tracker: &mut Tracker<'_>) -> Tentative {
        match tracker.advance(self.sample_optical_depth()) {
            None => Tentative::None,
            Some(_) if !self.step() => Tentative::TooMany,
            Some(collision) => Tentative::Collision(collision),
        }
    }

    /// Counts a collision, or a surface that a connection passes; false at the limit.
    #[inline]
    pub(super) fn step(&mut self) -> bool {
        self.collisions.step()
    }

    /// A random optical depth, exponentially distributed with rate one.
    #[inline]
    fn sample_optical_depth(&mut self) -> f32 {
        -(1.0 - self.sampler.next_1d()).ln()
    }

    /// The random numbers for distances.
    #[inline]
    pub(super) fn sampler(&mut self) -> &mut Sampler {
        &mut self.sampler
    }
}

/// The event of a real collision, reached by `step`.
fn collision(vertex: MediumVertex, weights: &mut Weights, step: &Step) -> Event {
    if weights.advance(step) { Event::Scattering(vertex) } else { Event::End }
}

/// The event at the end of a ray without a collision.
fn at_end(hit: Option<Hit>) -> Event {
    hit.map_or(Event::Escape, Event::Surface)
}

/// The medium that a path enters when it leaves a surface, having arrived through `medium`.
#[inline]
pub(super) fn medium_beyond(
    scene: &Scene,
    surface: &SurfaceInteraction,
    direction: Vec3,
    medium: Option<MediumId>,
) -> Option<MediumId> {
    match scene.medium_interface(surface) {
        Some(medium_interface) => medium_interface.towards(surface.normal, direction),
        None => medium,
    }
}

/// exp(−σ t), and 1 without extinction at any distance, even infinite.
#[inline]
pub(super) fn transmittance(extinction: Spectrum, t: f32) -> Spectrum {
    extinction.map(|sigma| if sigma > 0.0 { (-sigma * t).exp() } else { 1.0 })
}
