//! `path`: unidirectional path tracing with next-event estimation.
//!
//! [`Path::sample`](Integrator::sample) is the algorithm.
//! [`Path::sample_batch`](Integrator::sample_batch) traces many paths at once, with bit-identical
//! results.

mod batch;
mod step;
mod wavefront;

use crate::estimator::VertexNumbers;
use crate::integrator::{CameraRay, Integrator, Radiance, Start};
use crate::options::IntegratorOptions;
use crate::parameters::{
    CLAMP_INDIRECT, HIDE_EMITTERS, MAX_DEPTH, PathParameters, RR_DEPTH, STRICT_NORMALS,
    read_strict_normals,
};
use crate::watch::{Watch, WorkLimit};
use etendue_document::Parameters;
use etendue_sampling::Sampler;
use etendue_scene::{Manual, Scene};
use step::{PathState, Step};
use wavefront::Wavefront;

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "Path tracing: at every vertex an emitter is sampled and the material is sampled, and both \
              are combined by multiple importance sampling.",
    parameters: &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS, STRICT_NORMALS, CLAMP_INDIRECT],
    sample: r#"<integrator type="path"><integer name="max_depth" value="8"/></integrator>"#,
};

/// The path tracer.
#[derive(Clone, Debug)]
pub struct Path {
    parameters: PathParameters,
}

impl Path {
    /// Reads a path tracer.
    #[must_use]
    pub fn build(parameters: &Parameters<'_>, options: &IntegratorOptions) -> Self {
        let strict_normals = read_strict_normals(parameters);
        let common = PathParameters::read(parameters, options);
        Self { parameters: PathParameters { strict_normals, ..common } }
    }
}

impl Integrator for Path {
    fn clamp_indirect(&self) -> Option<f32> {
        self.parameters.clamp_indirect.limit()
    }

    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        sampler: &mut Sampler,
        _: &mut [f32],
        watch: &Watch<'_>,
    ) -> Radiance {
        let mut ray = start.ray;
        let mut path = PathState::new(ray.origin, *sampler);
        let mut edges = WorkLimit::edges(watch);
        for depth in 0..self.parameters.limits.max_depth {
            if !edges.step() {
                break;
            }
            let step = Step { parameters: &self.parameters, scene, depth };

            // Find the next surface, or else distant light.
            let Some(surface) = step.next_surface(&mut path, &mut ray) else {
                step.escape(&mut path, &ray);
                break;
            };

            // Add light emitted by the surface.
            step.add_emission(&mut path, &surface, &ray);
            if !step.scatters(&surface, &ray) {
                path.alpha.cover();
                break;
            }

            // Prepare shading.
            let bsdf = scene.prepare_bsdf(&surface);
            let numbers = VertexNumbers::draw(&mut path.sampler);

            // Next-event estimation: add light from one emitter unless it is occluded.
            if let Some(light) = step.propose_light(&surface, &bsdf, numbers.light)
                && !scene.occluded(&light.shadow_ray)
            {
                let light = path.throughput * light.radiance;
                path.radiance += step.limit_reflected(&path, light);
            }

            // Sample the next direction, or end the path.
            let continuation = step.sample_direction(&path, &surface, &bsdf, &numbers);
            if !continuation.null {
                path.alpha.cover();
            }
            if !continuation.exists {
                break;
            }
            ray = path.advance(step.next_vertex(&surface, &continuation));
        }
        *sampler = path.sampler;
        path.result()
    }

    fn sample_batch(
        &self,
        scene: &Scene,
        rays: &mut [CameraRay],
        _: &mut [f32],
        watch: &Watch<'_>,
        radiance: &mut Vec<Radiance>,
    ) {
        radiance.extend(Wavefront::new(&self.parameters, scene, rays).trace(watch));
    }
}
