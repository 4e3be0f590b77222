//! Paths that advance together, one vertex at a time.
//!
//! Each step is a loop over all paths that go on: trace the rays, look up the surfaces, propose light
//! and choose directions, trace the shadow rays. The vertices on triangles are sorted by what kind of
//! material they have, and those of a kind are shaded together, one to a SIMD lane ([`Batch`]); the
//! others one by one. The results are those of one path after another.
//!
//! One by one, too, it gains a tenth to go in steps: what one path does is a long chain in which every
//! number waits for the one before, and in short loops the processor works on several chains at once.

use super::Path;
use super::batch::{Batch, Stage, places};
use crate::light::{NextEvent, Origin, beyond_emitters, distant, emitted};
use crate::thin_sheet::ThinSheet;
use crate::{CameraRay, Radiance};
use etendue_math::Ray;
use etendue_math::lanes::{MAX_LANES, Real};
use etendue_sampling::Sampler;
use etendue_scene::bsdf::{Bsdf, BsdfSample, LaneKind, Lobe, Transport};
use etendue_scene::emitter::DirectionSample;
use etendue_scene::shape::Geometry;
use etendue_scene::{Hit, MaterialId, Scene, ShapeId, SurfaceInteraction};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::Vec2;

/// A path on its way.
pub(super) struct State {
    pub(super) stream: Sampler,
    /// The last vertex, and how it chose the direction of the ray that leaves it.
    origin: Origin,
    /// The share of the light at the end of that ray that arrives at the camera.
    throughput: Spectrum,
    /// The index of refraction here relative to the camera's: light that will leave glass again is
    /// not lost to roulette for being compressed in it.
    eta: f32,
    /// The masked sheet that the path has just passed straight through.
    sheet: Option<ThinSheet>,
    radiance: Spectrum,
    alpha: f32,
}

/// Where a path has met a surface.
struct Vertex {
    /// Which of the paths.
    path: usize,
    surface: SurfaceInteraction,
}

/// The random numbers of a vertex.
struct VertexNumbers {
    /// For the choice of an emitter and a point of it.
    light: Vec2,
    /// For the direction in which the path goes on.
    direction: Vec2,
    /// For the choice of a lobe, and for Russian roulette.
    choices: Vec2,
}

/// Light that is a path's if its shadow ray is free.
pub(super) struct PendingContribution {
    /// Which of the paths.
    pub(super) path: usize,
    pub(super) radiance: Spectrum,
}

/// Light that was proposed, and beside it the rays that must be free.
#[derive(Default)]
struct Shadows {
    pending: Vec<PendingContribution>,
    rays: Vec<Ray>,
}

/// Into how many groups the rays to lights are divided, at most.
const LIGHT_GROUPS: usize = 8;

/// Where a path has met a triangle whose material is shaded in lanes.
struct Arrival {
    /// Which of the paths.
    path: usize,
    /// Which of the rays.
    ray: usize,
    hit: Hit,
    material: MaterialId,
}

/// The paths of a batch of camera rays.
pub(super) struct Wavefront<'a> {
    integrator: &'a Path,
    scene: &'a Scene,
    paths: Vec<State>,
    /// Edges of all paths so far.
    depth: u32,
    /// The paths that go on, and beside them the rays that they go on with.
    active: Vec<usize>,
    rays: Vec<Ray>,
    /// The rays that led to the present vertices.
    arriving: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// The vertices to be shaded in lanes, by the kind of their materials.
    arrivals: [Vec<Arrival>; LaneKind::COUNT],
    /// The vertices to be shaded one by one.
    vertices: Vec<Vertex>,
    numbers: Vec<VertexNumbers>,
    /// Light that may arrive at the vertices.
    lights: Vec<Option<DirectionSample>>,
    /// One for each group of lights. From the first vertices, which lie side by side, the rays to one
    /// light are coherent, and the tree takes them in packets; later there is one group.
    shadows: Vec<Shadows>,
    occluded: Vec<bool>,
    block: Batch<'a>,
}

impl State {
    fn new(ray: &CameraRay) -> Self {
        Self {
            stream: ray.sampler,
            origin: Origin { point: ray.start.ray.origin, pdf: None },
            throughput: Spectrum::ONE,
            eta: 1.0,
            sheet: None,
            radiance: Spectrum::ZERO,
            alpha: 0.0,
        }
    }
}

impl<'a> Wavefront<'a> {
    pub(super) fn new(integrator: &'a Path, scene: &'a Scene, rays: &[CameraRay]) -> Self {
        let count = rays.len();
        let groups = scene.emitter_count().clamp(1, LIGHT_GROUPS);
        Self {
            integrator,
            scene,
            paths: rays.iter().map(State::new).collect(),
            depth: 0,
            active: (0..count).collect(),
            rays: rays.iter().map(|camera| camera.start.ray).collect(),
            arriving: Vec::with_capacity(count),
            hits: Vec::with_capacity(count),
            arrivals: Default::default(),
            vertices: Vec::with_capacity(count),
            numbers: Vec::with_capacity(count),
            lights: Vec::with_capacity(count),
            shadows: (0..groups).map(|_| Shadows::new(count)).collect(),
            occluded: Vec::with_capacity(count),
            block: Batch::new(),
        }
    }

    /// Follows all paths to their ends.
    pub(super) fn trace(mut self) -> impl Iterator<Item = Radiance> {
        if self.integrator.max_depth == 0 {
            self.active.clear();
        }
        while !self.active.is_empty() {
            self.hits.clear();
            self.scene.closest_hits(&self.rays, &mut self.hits);
            self.look_beyond();
            self.arrive();
            self.leave();
            self.shade_in_lanes();
            self.draw();
            self.light();
            self.scatter();
            self.gather();
            self.depth += 1;
        }
        self.paths.into_iter().map(|path| Radiance { color: path.radiance, alpha: path.alpha })
    }

    /// Replaces hits that do not count: hidden emitters, and the rest of masked sheets.
    fn look_beyond(&mut self) {
        for ((&index, ray), hit) in self.active.iter().zip(&mut self.rays).zip(&mut self.hits) {
            let path = &mut self.paths[index];
            if let Some(sheet) = path.sheet.take() {
                *hit = hit.and_then(|hit| beyond_sheet(self.scene, sheet, ray, hit));
            } else if self.integrator.hide_emitters && self.depth == 0 {
                *hit = hit.and_then(|hit| beyond_emitters(self.scene, ray, hit));
            }
        }
    }

    /// Looks up what the rays have met, and takes the light found there.
    fn arrive(&mut self) {
        let Self { integrator, scene, depth, .. } = *self;
        self.vertices.clear();
        self.arrivals.iter_mut().for_each(Vec::clear);
        let is_last = depth + 1 >= integrator.max_depth;
        for (ray_index, (&index, hit)) in self.active.iter().zip(&self.hits).enumerate() {
            let (path, ray) = (&mut self.paths[index], &self.rays[ray_index]);
            let Some(hit) = hit else {
                integrator.escape(scene, (path, depth), ray);
                continue;
            };
            if !is_last && let Some((kind, material)) = scene.lane_kind(hit) {
                let arrivals = &mut self.arrivals[kind.index()];
                if arrivals.is_empty() {
                    arrivals.reserve(self.hits.len());
                }
                arrivals.push(Arrival { path: index, ray: ray_index, hit: *hit, material });
                if depth == 0 {
                    path.alpha = 1.0;
                }
                continue;
            }
            let surface = scene.interaction(ray, hit);
            path.radiance +=
                path.throughput * emitted(scene, &surface, ray.direction, &path.origin);
            if !is_last && integrator.scatters(&surface, ray) {
                self.vertices.push(Vertex { path: index, surface });
            } else if depth == 0 {
                path.alpha = 1.0;
            }
        }
    }

    /// Keeps the rays that have arrived, and makes room for those that go on.
    fn leave(&mut self) {
        std::mem::swap(&mut self.rays, &mut self.arriving);
        self.rays.clear();
        self.active.clear();
    }

    /// Shades the vertices whose materials can be, many at once.
    fn shade_in_lanes(&mut self) {
        let arrivals = std::mem::take(&mut self.arrivals);
        for (kind, arrivals) in LaneKind::ALL.into_iter().zip(&arrivals) {
            for chunk in arrivals.chunks(MAX_LANES) {
                self.shade_block(kind, chunk);
            }
        }
        self.arrivals = arrivals;
    }

    fn shade_block(&mut self, kind: LaneKind, arrivals: &[Arrival]) {
        let Self { integrator, scene, depth, .. } = *self;
        let block = &mut self.block;
        block.start(kind, arrivals.len());
        let mut emitting = 0;
        for (place, arrival) in arrivals.iter().enumerate() {
            let shape = scene.shape(ShapeId(arrival.hit.geometry));
            let Geometry::Mesh(mesh) = &shape.geometry else {
                unreachable!("only triangles are shaded in lanes");
            };
            emitting |= u32::from(shape.emitter.is_some()) << place;
            let direction = self.arriving[arrival.ray].direction;
            block.triangles.set(place, mesh, &arrival.hit, direction);
            let path = &self.paths[arrival.path];
            block.set_path(place, arrival.path, (path.throughput, path.eta));
        }
        block.arrive(scene);
        for place in places(emitting) {
            let Arrival { path, ray, hit, .. } = &arrivals[place];
            let (path, direction) = (&mut self.paths[*path], self.arriving[*ray].direction);
            let surface = block.surfaces.interaction(place, hit);
            path.radiance += path.throughput * emitted(scene, &surface, direction, &path.origin);
        }
        for (place, arrival) in arrivals.iter().enumerate() {
            block.set_material(scene, place, (arrival.material, &arrival.hit));
        }
        block.draw(scene.level(), &mut self.paths);
        block.shade(Stage { integrator, scene, depth });
        let shadows = grouped(&mut self.shadows, depth);
        for (contribution, choice, ray) in block.pending_contributions() {
            keep_pending(shadows, (contribution, choice), ray);
        }
        for next in block.continuations() {
            let path = &mut self.paths[next.path];
            (path.origin, path.throughput, path.eta) = (next.origin, next.throughput, next.eta);
            if next.straight {
                let shape = ShapeId(arrivals[next.place].hit.geometry);
                path.pass(ThinSheet::new(shape, next.origin.point), depth);
            } else {
                path.alpha = 1.0;
            }
            self.active.push(next.path);
            self.rays.push(next.ray);
        }
    }

    /// Draws the random numbers of the vertices. Every vertex has the same six, used or not: what a
    /// path draws at a depth does not depend on what it met before.
    fn draw(&mut self) {
        self.numbers.clear();
        for vertex in &self.vertices {
            let stream = &mut self.paths[vertex.path].stream;
            self.numbers.push(VertexNumbers {
                light: stream.next_2d(),
                direction: stream.next_2d(),
                choices: stream.next_independent_2d(),
            });
        }
    }

    /// Chooses light for the vertices whose materials may reflect any.
    fn light(&mut self) {
        let Self { integrator, scene, .. } = *self;
        self.lights.clear();
        for (Vertex { surface, .. }, numbers) in self.vertices.iter().zip(&self.numbers) {
            let wanted = integrator.emitter_sampling && scene.may_reflect_emitters(surface);
            self.lights
                .push(wanted.then(|| scene.sample_light(surface.point, numbers.light)).flatten());
        }
    }

    /// Resolves the materials: what they reflect of the light chosen, and where the paths go on.
    fn scatter(&mut self) {
        let Self { integrator, scene, depth, .. } = *self;
        let next_event =
            NextEvent { strict_normals: integrator.strict_normals, scatter_ratio: 1.0 };
        let shadows = grouped(&mut self.shadows, depth);
        for ((vertex, numbers), light) in self.vertices.iter().zip(&self.numbers).zip(&self.lights)
        {
            let Vertex { path: index, surface } = vertex;
            let path = &mut self.paths[*index];
            let bsdf = scene.prepare_bsdf(surface);
            if let Some(light) = light
                && bsdf.has_smooth_lobe()
                && let Some(light) = next_event.reflect(surface, &bsdf, light)
            {
                let radiance = path.throughput * light.radiance;
                let contribution = PendingContribution { path: *index, radiance };
                keep_pending(shadows, (contribution, numbers.light.x), light.shadow_ray);
            }
            if let Some(ray) = integrator.scatter((path, depth), surface, &bsdf, numbers)
                && (depth + 1 < integrator.rr_depth || path.survives(numbers.choices.y))
            {
                self.active.push(*index);
                self.rays.push(ray);
            }
        }
    }

    /// Keeps the pending of light that nothing stands between.
    fn gather(&mut self) {
        for Shadows { pending, rays } in grouped(&mut self.shadows, self.depth) {
            self.occluded.clear();
            self.scene.occluded_many(rays, &mut self.occluded);
            for (contribution, &occluded) in pending.iter().zip(&self.occluded) {
                if !occluded {
                    self.paths[contribution.path].radiance += contribution.radiance;
                }
            }
            pending.clear();
            rays.clear();
        }
    }
}

impl Shadows {
    fn new(count: usize) -> Self {
        Self { pending: Vec::with_capacity(count), rays: Vec::with_capacity(count) }
    }
}

/// The groups that rays to lights are divided into at a depth.
fn grouped(shadows: &mut [Shadows], depth: u32) -> &mut [Shadows] {
    let groups = if depth == 0 { shadows.len() } else { 1 };
    &mut shadows[..groups]
}

/// Keeps a contribution of light in the group of the emitter that the random number has chosen.
#[inline(always)]
fn keep_pending(
    shadows: &mut [Shadows],
    (contribution, choice): (PendingContribution, f32),
    ray: Ray,
) {
    let last = shadows.len() - 1;
    let group = ((choice * shadows.len() as f32) as usize).min(last);
    let Shadows { pending, rays } = &mut shadows[group];
    pending.push(contribution);
    rays.push(ray);
}

impl Path {
    /// The ray has left the scene.
    fn escape(&self, scene: &Scene, (path, depth): (&mut State, u32), ray: &Ray) {
        if self.hide_emitters && depth == 0 {
            return;
        }
        path.radiance += path.throughput * distant(scene, ray.direction, &path.origin);
        if !self.hide_emitters && !scene.environments().is_empty() {
            path.alpha = 1.0;
        }
    }

    /// Whether light from the direction that the ray came from counts.
    #[inline(always)]
    fn scatters(&self, surface: &SurfaceInteraction, ray: &Ray) -> bool {
        !self.strict_normals || surface.normal.dot(ray.direction) * surface.wi.z < 0.0
    }

    /// Takes the next direction; `None` where there is none.
    #[inline(always)]
    fn scatter(
        &self,
        (path, depth): (&mut State, u32),
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        numbers: &VertexNumbers,
    ) -> Option<Ray> {
        if depth == 0 {
            path.alpha = 1.0;
        }
        let sample =
            bsdf.sample(surface.wi, numbers.choices.x, numbers.direction, Transport::Radiance);
        let BsdfSample { wo, weight, pdf, eta, lobe } = sample?;
        let direction = surface.to_world(wo);
        if self.strict_normals && lobe != Lobe::Null && direction.dot(surface.normal) * wo.z <= 0.0
        {
            return None;
        }
        match lobe {
            Lobe::Null => path.pass(ThinSheet::new(surface.shape, surface.point), depth),
            _ => path.alpha = 1.0,
        }
        path.throughput *= weight;
        path.eta *= eta;
        let competing = self.emitter_sampling && lobe.is_smooth();
        path.origin = Origin { point: surface.point, pdf: competing.then_some(pdf) };
        (!path.throughput.is_black()).then(|| surface.spawn_ray(direction))
    }
}

impl State {
    /// Goes straight through a sheet, which the camera then does not see.
    fn pass(&mut self, sheet: ThinSheet, depth: u32) {
        self.sheet = Some(sheet);
        if depth == 0 {
            self.alpha = 0.0;
        }
    }

    /// Russian roulette; see [`roulette`].
    #[inline(always)]
    fn survives(&mut self, random: f32) -> bool {
        let (survives, gain) = roulette::<f32>(self.throughput.into(), self.eta, random);
        self.throughput *= gain;
        survives
    }
}

/// Russian roulette: paths that carry little end early, and the survivors stand for them by what they
/// gain.
#[inline(always)]
pub(super) fn roulette<R: Real>(throughput: SpectrumLanes<R>, eta: R, random: R) -> (R::Mask, R) {
    let probability = (throughput.max_component() * eta * eta).min(eta.like(0.95));
    (random.lt(probability), probability.reciprocal())
}

/// Goes on through the rest of a sheet.
#[cold]
fn beyond_sheet(scene: &Scene, mut sheet: ThinSheet, ray: &mut Ray, mut hit: Hit) -> Option<Hit> {
    loop {
        let surface = scene.interaction(ray, &hit);
        if !sheet.holds(&surface) {
            return Some(hit);
        }
        *ray = surface.spawn_ray(ray.direction);
        hit = scene.closest_hit(ray)?;
    }
}
