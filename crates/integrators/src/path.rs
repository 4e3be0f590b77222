//! `path`: unidirectional path tracing with next-event estimation.

use crate::light::{NextEvent, Origin, distant, emitted};
use crate::{Integrator, Radiance};
use etendue_document::{Fault, Parameters};
use etendue_math::Ray;
use etendue_render::bsdf::{Bsdf, BsdfSample, Lobe, Transport};
use etendue_render::{Hit, Manual, ParameterManual, Scene, ShapeId, SurfaceInteraction};
use etendue_sampling::SampleStream;
use etendue_spectrum::Spectrum;
use glam::Vec2;

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "Path tracing: at every vertex an emitter is sampled and the material is sampled, and both \
              are combined by multiple importance sampling.",
    parameters: &[
        ParameterManual {
            name: "max_depth",
            kind: "integer",
            default: "-1",
            meaning: "The longest path, in edges: 1 shows emitters alone, 2 direct light, −1 has no limit.",
        },
        ParameterManual {
            name: "rr_depth",
            kind: "integer",
            default: "5",
            meaning: "From this depth on, paths end by Russian roulette.",
        },
        ParameterManual {
            name: "hide_emitters",
            kind: "boolean",
            default: "false",
            meaning: "The camera does not see emitters.",
        },
        ParameterManual {
            name: "strict_normals",
            kind: "boolean",
            default: "false",
            meaning: "Light must be on the same side of the geometric as of the shading normal.",
        },
    ],
    sample: r#"<integrator type="path"><integer name="max_depth" value="8"/></integrator>"#,
};

/// The path tracer.
#[derive(Clone, Debug)]
pub struct Path {
    /// The longest path, in edges.
    pub max_depth: u32,
    /// From this depth on, paths end by Russian roulette.
    pub rr_depth: u32,
    /// Whether the camera passes through emitters.
    pub hide_emitters: bool,
    /// Whether light must be on the same side of the geometric as of the shading normal.
    pub strict_normals: bool,
    /// Whether emitters are sampled; without, light is found by chance alone.
    pub emitter_sampling: bool,
}

impl Path {
    /// Reads a path tracer.
    #[must_use]
    pub fn build(parameters: &Parameters<'_>, emitter_sampling: bool) -> Self {
        let (max_depth, rr_depth) = depths(parameters);
        Self {
            max_depth,
            rr_depth,
            hide_emitters: parameters.boolean("hide_emitters", false),
            strict_normals: parameters.boolean("strict_normals", false),
            emitter_sampling,
        }
    }
}

/// Reads the greatest length of paths, and the depth from which on they end by roulette.
pub(crate) fn depths(parameters: &Parameters<'_>) -> (u32, u32) {
    let max_depth = parameters.integer("max_depth", -1);
    if max_depth < -1 {
        let message = "expected −1 (no limit), or a length of 0 or more";
        parameters.error(Fault::BadValue, "max_depth", message);
    }
    let rr_depth = parameters.integer_in("rr_depth", 5, 1..=i64::from(u32::MAX)) as u32;
    (u32::try_from(max_depth).unwrap_or(u32::MAX), rr_depth)
}

/// A path on its way.
struct State {
    ray: Ray,
    /// The last vertex, and how it chose the direction of `ray`.
    origin: Origin,
    /// The share of the light at the end of `ray` that arrives at the camera.
    throughput: Spectrum,
    /// The index of refraction here relative to the camera's: light that will leave glass again is
    /// not lost to roulette for being compressed in it.
    eta: f32,
    /// The masked sheet that the path has just passed straight through.
    sheet: Option<Sheet>,
    /// Edges so far.
    depth: u32,
    radiance: Spectrum,
    alpha: f32,
}

/// A surface that lets light straight through: its back face, if it has one close by, is part of it.
///
/// Blinds and leaves are often modelled as thin boxes with a `mask`. Their opacity is meant for the
/// sheet, not for each face of it, and Mitsuba renders it so, because its rays start 1,500 roundings
/// beyond the front face. Ours start right behind it, so the rule is stated: the same shape, met
/// again within that distance, is not met.
#[derive(Clone, Copy, Debug)]
struct Sheet {
    shape: ShapeId,
    thickness: f32,
}

impl Sheet {
    fn at(surface: &SurfaceInteraction) -> Self {
        let thickness = (1.0 + surface.point.abs().max_element()) * 1500.0 * (0.5 * f32::EPSILON);
        Self { shape: surface.shape, thickness }
    }

    /// Whether the sheet's other face is met within the thickness that is left, which shrinks.
    fn holds(&mut self, surface: &SurfaceInteraction) -> bool {
        self.thickness -= surface.t;
        surface.shape == self.shape && self.thickness >= 0.0
    }
}

impl Integrator for Path {
    fn sample(
        &self,
        scene: &Scene,
        ray: &Ray,
        stream: &mut SampleStream,
        _: &mut [f32],
    ) -> Radiance {
        let mut path = State {
            ray: *ray,
            origin: Origin { point: ray.origin, pdf: None },
            throughput: Spectrum::ONE,
            eta: 1.0,
            sheet: None,
            depth: 0,
            radiance: Spectrum::ZERO,
            alpha: 0.0,
        };
        while path.depth < self.max_depth {
            let Some(hit) = self.next_hit(scene, &mut path) else {
                self.escape(scene, &mut path);
                break;
            };
            let surface = scene.interaction(&path.ray, &hit);
            path.radiance +=
                path.throughput * emitted(scene, &surface, path.ray.direction, &path.origin);
            if path.depth + 1 >= self.max_depth
                || !self.continues(scene, &mut path, &surface, stream)
            {
                path.alpha = path.alpha.max(if path.depth == 0 { 1.0 } else { 0.0 });
                break;
            }
        }
        Radiance { color: path.radiance, alpha: path.alpha }
    }
}

impl Path {
    /// Where the path goes on. Most vertices need no more than the first line.
    #[inline]
    fn next_hit(&self, scene: &Scene, path: &mut State) -> Option<Hit> {
        let hit = scene.closest_hit(&path.ray)?;
        let hiding = self.hide_emitters && path.depth == 0;
        if hiding || path.sheet.is_some() { self.skip(scene, path, hit) } else { Some(hit) }
    }

    /// Goes on through emitters that are hidden, or through the rest of a sheet.
    #[cold]
    fn skip(&self, scene: &Scene, path: &mut State, mut hit: Hit) -> Option<Hit> {
        let mut sheet = path.sheet.take();
        loop {
            let surface = scene.interaction(&path.ray, &hit);
            let skipped = match &mut sheet {
                Some(sheet) => sheet.holds(&surface),
                None => scene.emitter_of(&surface).is_some(),
            };
            if !skipped {
                return Some(hit);
            }
            path.ray = surface.spawn_ray(path.ray.direction);
            hit = scene.closest_hit(&path.ray)?;
        }
    }

    /// The ray has left the scene.
    fn escape(&self, scene: &Scene, path: &mut State) {
        if self.hide_emitters && path.depth == 0 {
            return;
        }
        path.radiance += path.throughput * distant(scene, path.ray.direction, &path.origin);
        if !self.hide_emitters && !scene.environments().is_empty() {
            path.alpha = 1.0;
        }
    }

    /// Gathers light at a vertex and goes on from there; false where the path ends.
    fn continues(
        &self,
        scene: &Scene,
        path: &mut State,
        surface: &SurfaceInteraction,
        stream: &mut SampleStream,
    ) -> bool {
        let inconsistent = surface.normal.dot(path.ray.direction) * surface.wi.z >= 0.0;
        if self.strict_normals && inconsistent {
            return false;
        }
        let bsdf = scene.prepare_bsdf(surface);
        let first_dimension = stream.dimension();
        if self.emitter_sampling && bsdf.has_smooth_lobe() {
            let next_event = NextEvent { strict_normals: self.strict_normals, scatter_ratio: 1.0 };
            let light = next_event.estimate(scene, surface, &bsdf, stream.next_2d());
            path.radiance += path.throughput * light;
        }
        // Every vertex has the same six numbers, used or not: what a path draws at a depth does not
        // depend on what it met before.
        stream.set_dimension(first_dimension.wrapping_add(2));
        let direction = stream.next_2d();
        let Vec2 { x: lobe, y: roulette } = stream.next_independent_2d();
        self.scatter(path, surface, &bsdf, (lobe, direction)) && self.survives(path, roulette)
    }

    /// Takes the next direction; false where there is none.
    fn scatter(
        &self,
        path: &mut State,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        (lobe, direction): (f32, Vec2),
    ) -> bool {
        let sample = bsdf.sample(surface.wi, lobe, direction, Transport::Radiance);
        let Some(BsdfSample { wo, weight, pdf, eta, lobe }) = sample else { return false };
        let direction = surface.to_world(wo);
        if self.strict_normals && lobe != Lobe::Null && direction.dot(surface.normal) * wo.z <= 0.0
        {
            return false;
        }
        match lobe {
            Lobe::Null => path.sheet = Some(Sheet::at(surface)),
            _ => path.alpha = 1.0,
        }
        path.throughput *= weight;
        path.eta *= eta;
        path.ray = surface.spawn_ray(direction);
        let competing = self.emitter_sampling && lobe.is_smooth();
        path.origin = Origin { point: surface.point, pdf: competing.then_some(pdf) };
        path.depth += 1;
        !path.throughput.is_black()
    }

    /// Russian roulette: paths that carry little end early, and the survivors stand for them.
    fn survives(&self, path: &mut State, random: f32) -> bool {
        if path.depth < self.rr_depth {
            return true;
        }
        let probability = (path.throughput.max_component() * path.eta * path.eta).min(0.95);
        if random >= probability {
            return false;
        }
        path.throughput *= 1.0 / probability;
        true
    }
}
