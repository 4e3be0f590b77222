//! Flights through media: where a path collides next.

use super::weights::{Step, Weights};
use etendue_math::Ray;
use etendue_sampling::Sampler;
use etendue_scene::medium::{Density, Heterogeneous, Homogeneous, Medium};
use etendue_scene::phase::MediumInteraction;
use etendue_scene::{Hit, MediumId, Scene, SurfaceInteraction};
use etendue_spectrum::Spectrum;
use glam::Vec3;

/// What a ray comes to.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Event {
    /// It scatters in a medium, at this point.
    Scattering(MediumId, Vec3),
    /// It meets a surface.
    Surface(Hit),
    /// It leaves the scene.
    Escape,
    /// Nothing of it is left.
    End,
}

/// A ray on its way, and the medium that it is in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MediumWalk {
    pub(crate) ray: Ray,
    pub(crate) medium: Option<MediumId>,
    /// The numbers for distances. They are apart from those of the vertices, whose dimensions do not
    /// depend on how many collisions there are.
    numbers: Sampler,
    /// The channel that leads.
    channel: usize,
}

/// Vertices take their numbers from below this dimension, distances from above.
const FIRST_DIMENSION: u32 = 1 << 24;

impl MediumWalk {
    pub(crate) fn new(ray: Ray, medium: Option<MediumId>, stream: &Sampler) -> Self {
        let mut numbers = *stream;
        numbers.set_dimension(FIRST_DIMENSION);
        let lanes = Spectrum::LANES;
        let channel = ((numbers.next_1d() * lanes as f32) as usize).min(lanes - 1);
        Self { ray, medium, numbers, channel }
    }

    /// Leaves a surface towards `direction`.
    #[inline]
    pub(crate) fn leave(&mut self, scene: &Scene, surface: &SurfaceInteraction, direction: Vec3) {
        self.ray = surface.spawn_ray(direction);
        self.medium = medium_beyond(scene, surface, direction, self.medium);
    }

    /// Goes on to the next event.
    #[inline]
    pub(crate) fn travel(&mut self, scene: &Scene, weights: &mut Weights) -> Event {
        let Some(id) = self.medium else {
            return at_end(scene.closest_hit(&self.ray));
        };
        let medium = scene.medium(id);
        match &medium.density {
            Density::Homogeneous(density) => {
                self.sample_distance(scene, (id, medium, density), weights)
            }
            Density::Heterogeneous(density) => self.track(scene, (id, medium, density), weights),
        }
    }

    /// Through a homogeneous medium: the distance to the next collision has a closed form, and
    /// nothing beyond it need be intersected.
    fn sample_distance(
        &mut self,
        scene: &Scene,
        (id, medium, density): (MediumId, &Medium, &Homogeneous),
        weights: &mut Weights,
    ) -> Event {
        let site = MediumInteraction { point: self.ray.origin, wi: -self.ray.direction };
        let extinction = density.extinction() * medium.phase.projected_area(&site);
        let t = self.optical_depth() / extinction[self.channel];
        let before = Ray { t_max: t.min(self.ray.t_max), ..self.ray };
        let hit = scene.closest_hit(&before);
        if hit.is_none() && t < self.ray.t_max {
            let passed = transmittance(extinction, t);
            let point = self.ray.at(t);
            let value = passed * extinction * density.albedo(point);
            let step = Step { value, unidirectional_pdf: passed * extinction, light_pdf: 0.0 };
            return if weights.go(&step) { Event::Scattering(id, point) } else { Event::End };
        }
        let passed = transmittance(extinction, hit.map_or(self.ray.t_max, |hit| hit.t));
        // A connection to an emitter would pass for certain, by the closed form.
        let step = Step { value: passed, unidirectional_pdf: passed, light_pdf: 1.0 };
        if weights.go(&step) { at_end(hit) } else { Event::End }
    }

    /// Through a heterogeneous medium: delta tracking.
    fn track(
        &mut self,
        scene: &Scene,
        (id, medium, density): (MediumId, &Medium, &Heterogeneous),
        weights: &mut Weights,
    ) -> Event {
        let hit = scene.closest_hit(&self.ray);
        let t_max = hit.map_or(self.ray.t_max, |hit| hit.t);
        let mut tracker = density.track(&Ray { t_max, ..self.ray });
        while let Some(collision) = tracker.advance(self.optical_depth()) {
            let point = self.ray.at(collision.t);
            let found = medium.coefficients(&MediumInteraction { point, wi: -self.ray.direction });
            // Transmittances against the majorant are the same for all channels and cancel.
            let real = (found.extinction / collision.majorant).min(Spectrum::ONE);
            if self.numbers.next_1d() < real[self.channel] {
                let value = found.scattering / collision.majorant;
                let step = Step { value, unidirectional_pdf: real, light_pdf: 0.0 };
                return if weights.go(&step) { Event::Scattering(id, point) } else { Event::End };
            }
            let null = Spectrum::ONE - real;
            if !weights.go(&Step { value: null, unidirectional_pdf: null, light_pdf: 1.0 }) {
                return Event::End;
            }
        }
        at_end(hit)
    }

    /// A random optical depth, of the exponential distribution of rate one.
    #[inline]
    pub(super) fn optical_depth(&mut self) -> f32 {
        -(1.0 - self.numbers.next_1d()).ln()
    }

    /// The numbers for distances.
    #[inline]
    pub(super) fn numbers(&mut self) -> &mut Sampler {
        &mut self.numbers
    }
}

fn at_end(hit: Option<Hit>) -> Event {
    hit.map_or(Event::Escape, Event::Surface)
}

/// The medium that a path is in when it leaves a surface, having come through `medium`.
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

/// exp(−σ t), and 1 without extinction however far it is.
#[inline]
pub(super) fn transmittance(extinction: Spectrum, t: f32) -> Spectrum {
    extinction.map(|sigma| if sigma > 0.0 { (-sigma * t).exp() } else { 1.0 })
}
