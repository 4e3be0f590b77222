//! The state of a path and its steps, shared by the scalar loop and the wavefront.

use crate::estimator::{
    Alpha, Continuation, NextEvent, PathVertex, PathWeight, ProposedLight, ShadingPoint, ThinSheet,
    VertexNumbers, distant, emitted, skip_hits,
};
use crate::integrator::Radiance;
use crate::parameters::PathParameters;
use etendue_math::Ray;
use etendue_math::lanes::Vector2;
use etendue_sampling::Sampler;
use etendue_scene::bsdf::Bsdf;
use etendue_scene::{Hit, Scene, ShapeId, SurfaceInteraction};
use etendue_spectrum::Spectrum;
use glam::Vec3;

/// The state of a path. The ray is stored separately.
pub(super) struct PathState {
    pub(super) sampler: Sampler,
    /// The last vertex.
    pub(super) vertex: PathVertex,
    /// See [`PathWeight`].
    pub(super) throughput: Spectrum,
    /// See [`PathWeight`].
    pub(super) eta: f32,
    pub(super) sheet: ThinSheet,
    /// How many times the path has been scattered.
    pub(super) scattering_count: u32,
    pub(super) radiance: Spectrum,
    pub(super) alpha: Alpha,
}

/// Where and how a path continues.
#[derive(Clone, Copy)]
pub(super) struct NextVertex {
    pub(super) ray: Ray,
    /// The vertex it leaves.
    pub(super) vertex: PathVertex,
    /// The shape of that vertex.
    pub(super) shape: ShapeId,
    pub(super) throughput: Spectrum,
    pub(super) eta: f32,
    /// Whether it is transmitted unchanged, as if the surface were not there.
    pub(super) null: bool,
}

impl PathState {
    /// A path that starts at the camera.
    pub(super) fn new(origin: Vec3, sampler: Sampler) -> Self {
        Self {
            sampler,
            vertex: PathVertex::camera(origin),
            throughput: Spectrum::ONE,
            eta: 1.0,
            sheet: ThinSheet::default(),
            scattering_count: 0,
            radiance: Spectrum::ZERO,
            alpha: Alpha::default(),
        }
    }

    /// Continues the path; returns the ray.
    #[inline(always)]
    pub(super) fn advance(&mut self, next: NextVertex) -> Ray {
        if next.null {
            self.sheet.enter(next.shape, next.vertex.point);
        } else {
            self.scattering_count += 1;
        }
        (self.vertex, self.throughput, self.eta) = (next.vertex, next.throughput, next.eta);
        next.ray
    }

    /// The light that the path has found.
    pub(super) fn result(&self) -> Radiance {
        Radiance { color: self.radiance, alpha: self.alpha.value() }
    }
}

/// One step of any number of paths, from one vertex to the next: the data they share.
#[derive(Clone, Copy)]
pub(super) struct Step<'a> {
    pub(super) parameters: &'a PathParameters,
    pub(super) scene: &'a Scene,
    /// The number of edges so far.
    pub(super) depth: u32,
}

impl<'a> Step<'a> {
    /// Finds the next surface that a path hits.
    pub(super) fn next_surface(
        &self,
        path: &mut PathState,
        ray: &mut Ray,
    ) -> Option<SurfaceInteraction> {
        let mut hit = self.scene.closest_hit(ray);
        self.skip_hits(path, ray, &mut hit);
        hit.map(|hit| self.scene.interaction(ray, &hit))
    }

    /// Skips a hit that does not count: on a hidden emitter, or on the other face of a thin sheet.
    #[inline(always)]
    pub(super) fn skip_hits(&self, path: &mut PathState, ray: &mut Ray, hit: &mut Option<Hit>) {
        let hide_emitters = self.parameters.hide_emitters.seen_by(path.alpha);
        if path.sheet.is_entered() || hide_emitters.0 {
            let mut sheet = std::mem::take(&mut path.sheet);
            skip_hits(self.scene, ray, hit, &mut |surface| {
                sheet.holds(surface) || hide_emitters.hides(self.scene, surface)
            });
        }
    }

    /// Handles a path whose ray has left the scene.
    pub(super) fn escape(&self, path: &mut PathState, ray: &Ray) {
        if self.parameters.hide_emitters.seen_by(path.alpha).0 {
            return;
        }
        let light = path.throughput * distant(self.scene, ray.direction, &path.vertex);
        path.radiance += self.parameters.clamp_indirect.apply(light, path.scattering_count);
        path.alpha.escape(self.scene, self.parameters.hide_emitters);
    }

    /// Adds light that a surface emits.
    #[inline(always)]
    pub(super) fn add_emission(
        &self,
        path: &mut PathState,
        surface: &SurfaceInteraction,
        ray: &Ray,
    ) {
        let light = path.throughput * emitted(self.scene, surface, ray.direction, &path.vertex);
        path.radiance += self.parameters.clamp_indirect.apply(light, path.scattering_count);
    }

    /// Limits an emitter's light that the path's vertex reflects, if it is indirect.
    #[inline(always)]
    pub(super) fn limit_reflected(&self, path: &PathState, light: Spectrum) -> Spectrum {
        self.parameters.clamp_indirect.apply(light, path.scattering_count + 1)
    }

    /// Whether paths end at the surfaces they hit now.
    #[inline(always)]
    pub(super) fn is_last(&self) -> bool {
        self.depth + 1 >= self.parameters.limits.max_depth
    }

    /// Whether a path that has hit a surface is scattered there.
    #[inline(always)]
    pub(super) fn scatters(&self, surface: &SurfaceInteraction, ray: &Ray) -> bool {
        let strict_normals = self.parameters.strict_normals;
        let point = ShadingPoint::from(surface);
        !self.is_last() && strict_normals.cut_arrivals(true, &point, ray.direction.into())
    }

    /// The settings of next-event estimation.
    #[inline(always)]
    pub(super) fn next_event(&self) -> NextEvent {
        NextEvent { strict_normals: self.parameters.strict_normals, scatter_ratio: 1.0 }
    }

    /// Light from one randomly chosen emitter.
    #[inline(always)]
    pub(super) fn propose_light(
        &self,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        random: Vector2<f32>,
    ) -> Option<ProposedLight> {
        if !self.parameters.emitter_sampling {
            return None;
        }
        self.next_event().propose(self.scene, surface, bsdf, random.into())
    }

    /// Whether Russian roulette is active.
    #[inline(always)]
    pub(super) fn plays_roulette(&self) -> bool {
        self.depth + 1 >= self.parameters.limits.rr_depth
    }

    /// Samples the direction in which a path continues.
    #[inline(always)]
    pub(super) fn sample_direction(
        &self,
        path: &PathState,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        numbers: &VertexNumbers<f32>,
    ) -> Continuation<f32> {
        let weight = PathWeight { throughput: path.throughput.into(), eta: path.eta };
        let strict_normals = self.parameters.strict_normals;
        let mut continuation =
            Continuation::at_hit(surface, bsdf, weight, &numbers.scatter, strict_normals);
        if self.plays_roulette() {
            continuation.play_roulette(numbers.roulette);
        }
        continuation
    }

    /// Leaves a surface.
    #[inline(always)]
    pub(super) fn next_vertex(
        &self,
        surface: &SurfaceInteraction,
        continuation: &Continuation<f32>,
    ) -> NextVertex {
        let competes = self.parameters.emitter_sampling && continuation.smooth;
        let pdf = competes.then_some(continuation.pdf);
        NextVertex {
            ray: surface.spawn_ray(continuation.direction.into()),
            vertex: PathVertex { point: surface.point, pdf },
            shape: surface.shape,
            throughput: continuation.weight.throughput.into(),
            eta: continuation.weight.eta,
            null: continuation.null,
        }
    }
}
