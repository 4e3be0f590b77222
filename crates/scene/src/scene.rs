//! The frozen scene: immutable, flat, shared by all threads.

mod lights;
mod statistics;
mod tree;

use self::lights::LaneEmitters;
pub use self::statistics::SceneStatistics;
pub(crate) use self::tree::{Tree, TreeContent};
use crate::batch::{BatchMaterial, LaneKind, Materials};
use crate::bsdf::{Bsdf, Material};
use crate::cache::AssetCache;
use crate::emitter::{Emitter, SceneView};
use crate::film::FilmSpec;
use crate::ids::{EmitterId, InstanceId, MaterialId, MediumId, ShapeId};
use crate::interaction::SurfaceInteraction;
use crate::medium::{Medium, MediumInterface};
use crate::models::mesh::Mesh;
use crate::sensor::Sensor;
use crate::shape::instance::Instance;
use crate::shape::shapegroup::Group;
use crate::shape::{Geometry, Shape};
use crate::texture::{Texture, Textures};
use etendue_bvh::{Bvh, Hit, PrimitiveHit, Primitives, Tier};
use etendue_document::{Diagnostics, Fault};
use etendue_math::lanes::{Level, Real, baseline};
use etendue_math::{Bounds3, Ray};
use etendue_sampling::{AliasTable, SamplerSpec};
use std::sync::Arc;

/// A sensor with its film and sampler.
#[derive(Clone, Debug)]
pub struct SensorSetup {
    /// Its id in the scene file.
    pub id: Option<String>,
    /// The sensor.
    pub sensor: Sensor,
    /// Its film.
    pub film: FilmSpec,
    /// Its sampler and number of samples per pixel.
    pub sampler: SamplerSpec,
    /// The medium around it.
    pub medium: Option<MediumId>,
}

/// The parts of a scene.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    pub(crate) shapes: Vec<Shape>,
    /// How many of the first shapes are at the top level, not in groups; all if `None`.
    pub(crate) top_level_shapes: Option<usize>,
    pub(crate) instances: Vec<Instance>,
    pub(crate) groups: Vec<Group>,
    pub(crate) materials: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) emitters: Vec<Emitter>,
    /// The sampling weight of each emitter, relative to the others.
    pub(crate) emitter_weights: Vec<f32>,
    pub(crate) media: Vec<Medium>,
    /// The shapes that bound media.
    pub(crate) medium_interfaces: Vec<(ShapeId, MediumInterface)>,
    pub(crate) sensors: Vec<SensorSetup>,
    /// Digests of the shapes' geometry and of the groups' trees; only with a cache.
    pub(crate) geometry_digests: Vec<u128>,
    pub(crate) group_digests: Vec<u128>,
    pub(crate) hash: [u8; 32],
    /// The instruction set for rays, if not the fastest.
    pub(crate) tier: Option<Tier>,
}

/// A scene, ready to render.
#[derive(Debug)]
pub struct Scene {
    bvh: Arc<Bvh>,
    level: Level,
    shapes: Vec<Shape>,
    /// How many of the first shapes are at the top level, not in groups.
    top_level: usize,
    instances: Vec<Instance>,
    groups: Vec<Group>,
    materials: Vec<Material>,
    batch_materials: Vec<BatchMaterial>,
    textures: Vec<Texture>,
    emitters: Vec<Emitter>,
    /// Chooses emitters if they do not have equal probabilities.
    emitter_table: Option<AliasTable>,
    /// What lanes can sample of the emitters.
    lane_emitters: LaneEmitters,
    environments: Vec<EmitterId>,
    media: Vec<Medium>,
    /// The media at each shape; empty if no shape bounds a medium.
    medium_interfaces: Vec<Option<MediumInterface>>,
    sensors: Vec<SensorSetup>,
    hash: [u8; 32],
}

/// A light chosen for next-event estimation.
#[derive(Clone, Copy, Debug)]
pub struct EmitterChoice {
    /// The emitter.
    pub emitter: EmitterId,
    /// Its probability.
    pub probability: f32,
}

/// The shading instructions that match those for rays.
fn level(tier: Tier) -> Level {
    let best = Level::new();
    match tier {
        Tier::Portable => baseline(),
        #[cfg(target_arch = "x86_64")]
        Tier::Avx2 => best.as_avx2().map_or(best, Level::Avx2),
        _ => best,
    }
}

/// The table of emitters; `None` if all have equal probabilities.
fn emitter_table(weights: &[f32], diagnostics: &Diagnostics) -> Option<AliasTable> {
    if weights.windows(2).all(|pair| pair[0] == pair[1]) {
        return None;
    }
    let table = AliasTable::new(weights).ok();
    if table.is_none() {
        let message = "the sampling weights of the emitters cannot be summed: all count alike";
        diagnostics.warning(Fault::BadValue, None, message);
    }
    table
}

#[cold]
fn choose_by_weight(table: &AliasTable, random: &mut f32) -> EmitterChoice {
    let chosen = table.sample(*random);
    *random = chosen.rest.min(1.0 - f32::EPSILON);
    EmitterChoice { emitter: EmitterId(chosen.index as u32), probability: table.pmf(chosen.index) }
}

/// Chooses one of `count` indices by a number in [0, 1), and returns the rescaled number.
#[inline(always)]
pub(crate) fn choose_evenly<R: Real>(random: R, count: usize) -> (R, R) {
    let scaled = random * count as f32;
    let index = scaled.floor().min(random.like((count - 1) as f32));
    (index, (scaled - index).min(random.like(1.0 - f32::EPSILON)))
}

impl Scene {
    pub(crate) fn new(
        parts: Parts,
        cache: Option<&AssetCache>,
        diagnostics: &Diagnostics,
    ) -> Option<Self> {
        let top_level = parts.top_level_shapes.unwrap_or(parts.shapes.len());
        let content = TreeContent {
            shapes: &parts.shapes[..top_level],
            instances: &parts.instances,
            groups: &parts.groups,
            geometry_digests: parts.geometry_digests.get(..top_level).unwrap_or_default(),
            group_digests: &parts.group_digests,
        };
        let bvh = match content.build(parts.tier, cache) {
            Ok(tree) => tree.bvh,
            Err(problem) => {
                diagnostics.error(Fault::Geometry, None, problem);
                return None;
            }
        };
        let environments = (0_u32..)
            .zip(&parts.emitters)
            .filter(|(_, emitter)| emitter.is_environment())
            .map(|(index, _)| EmitterId(index))
            .collect();
        let mut medium_interfaces = Vec::new();
        for (shape, medium_interface) in parts.medium_interfaces {
            medium_interfaces.resize(parts.shapes.len(), None);
            medium_interfaces[shape.index()] = Some(medium_interface);
        }
        let mut sensors = parts.sensors;
        let bounds = bvh.bounds();
        sensors.iter_mut().for_each(|setup| setup.sensor.set_bounds(&bounds));
        Some(Self {
            level: level(bvh.tier()),
            bvh,
            lane_emitters: LaneEmitters::new(&parts.emitters, &parts.shapes),
            shapes: parts.shapes,
            top_level,
            instances: parts.instances,
            groups: parts.groups,
            batch_materials: BatchMaterial::of_all(&parts.materials),
            materials: parts.materials,
            textures: parts.textures,
            emitter_table: emitter_table(&parts.emitter_weights, diagnostics),
            emitters: parts.emitters,
            environments,
            media: parts.media,
            medium_interfaces,
            sensors,
            hash: parts.hash,
        })
    }

    /// The instruction set of path tracing.
    #[inline]
    #[must_use]
    pub fn level(&self) -> Level {
        self.level
    }

    /// The closest hit of `ray`.
    #[inline]
    #[must_use]
    pub fn intersect(&self, ray: &Ray) -> Option<SurfaceInteraction> {
        let hit = self.closest_hit(ray)?;
        Some(self.interaction(ray, &hit))
    }

    /// The closest hit of `ray` in the tree's terms, for [`Self::interaction`].
    #[inline(always)]
    #[must_use]
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.bvh.intersect(ray, self)
    }

    /// [`Self::closest_hit`] for many rays; appends the hits to `hits`.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        self.bvh.intersect_many(rays, self, hits);
    }

    /// The full interaction of `ray` at a hit.
    #[inline(always)]
    #[must_use]
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        if hit.instance != Hit::NO_INSTANCE {
            return self.instance_interaction(ray, hit);
        }
        let id = ShapeId(hit.geometry);
        self.shapes[id.index()].interaction(id, ray, hit)
    }

    /// The kind and id of a hit's material, if lanes can shade it. The hit must be on a top-level
    /// triangle.
    #[inline(always)]
    #[must_use]
    pub fn lane_kind(&self, hit: &Hit) -> Option<(LaneKind, MaterialId)> {
        if hit.instance != Hit::NO_INSTANCE {
            return None;
        }
        let shape = &self.shapes[hit.geometry as usize];
        if !matches!(shape.geometry, Geometry::Mesh(_)) {
            return None;
        }
        let kind = self.materials().lane_kind(shape.material)?;
        Some((kind, shape.material))
    }

    #[cold]
    fn instance_interaction(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        let placed = InstanceId(hit.instance - self.top_level as u32);
        let instance = &self.instances[placed.index()];
        let group = &self.groups[instance.group.index()];
        let id = ShapeId(group.first_shape.0 + hit.geometry);
        let local_ray = instance.to_world().inverse().ray(ray);
        let local = self.shapes[id.index()].interaction(id, &local_ray, hit);
        SurfaceInteraction { instance: Some(placed), ..instance.place(local, ray.direction) }
    }

    /// Whether `ray` hits anything.
    #[inline(always)]
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.bvh.occluded(ray, self)
    }

    /// [`Self::occluded`] for many rays; appends the answers to `occluded`.
    pub fn occluded_many(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        self.bvh.occluded_many(rays, self, occluded);
    }

    /// Resolves the material of a hit, which reads its textures.
    #[inline(always)]
    #[must_use]
    pub fn prepare_bsdf(&self, surface: &SurfaceInteraction) -> Bsdf<'_> {
        self.materials().prepare(self.shape(surface.shape).material, self.textures(), surface)
    }

    /// Whether a hit may reflect sampled light. False for mirrors, smooth glass and null materials.
    /// Where this is true, [`Bsdf::has_smooth_lobe`] decides.
    #[inline(always)]
    #[must_use]
    pub fn may_reflect_emitters(&self, surface: &SurfaceInteraction) -> bool {
        !self.materials[self.shape(surface.shape).material.index()].is_delta()
    }

    /// A shape.
    #[inline]
    #[must_use]
    pub fn shape(&self, id: ShapeId) -> &Shape {
        &self.shapes[id.index()]
    }

    /// All materials.
    #[inline]
    #[must_use]
    pub fn materials(&self) -> Materials<'_> {
        Materials { materials: &self.materials, batch: &self.batch_materials }
    }

    /// All textures.
    #[inline]
    #[must_use]
    pub fn textures(&self) -> Textures<'_> {
        Textures(&self.textures)
    }

    /// The number of emitters.
    #[inline]
    #[must_use]
    pub fn emitter_count(&self) -> usize {
        self.emitters.len()
    }

    /// An emitter.
    #[inline]
    #[must_use]
    pub fn emitter(&self, id: EmitterId) -> &Emitter {
        &self.emitters[id.index()]
    }

    /// All emitters.
    pub(crate) fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// Whether there may be any light.
    #[must_use]
    pub fn has_light(&self) -> bool {
        self.emitters.iter().any(|emitter| !emitter.is_black())
    }

    /// Chooses emitters if they do not have equal probabilities.
    pub(crate) fn emitter_table(&self) -> Option<&AliasTable> {
        self.emitter_table.as_ref()
    }

    /// What lanes can sample of the emitters.
    pub(crate) fn lane_emitters(&self) -> &LaneEmitters {
        &self.lane_emitters
    }

    /// The emitter of the shape that was hit.
    #[inline]
    #[must_use]
    pub fn emitter_of(&self, surface: &SurfaceInteraction) -> Option<EmitterId> {
        self.shapes[surface.shape.index()].emitter
    }

    /// The emitters that rays find when they leave the scene.
    #[inline]
    #[must_use]
    pub fn environments(&self) -> &[EmitterId] {
        &self.environments
    }

    /// Chooses an emitter, with equal probabilities by default. Rescales the random number for
    /// reuse.
    #[inline(always)]
    #[must_use]
    pub fn choose_emitter(&self, random: &mut f32) -> Option<EmitterChoice> {
        let count = self.emitters.len();
        if count == 0 {
            return None;
        }
        if let Some(table) = &self.emitter_table {
            return Some(choose_by_weight(table, random));
        }
        let (index, rest) = choose_evenly(*random, count);
        *random = rest;
        let index = (index as usize).min(count - 1);
        Some(EmitterChoice { emitter: EmitterId(index as u32), probability: 1.0 / count as f32 })
    }

    /// The probability with which [`Self::choose_emitter`] chooses `emitter`.
    #[inline]
    #[must_use]
    pub fn emitter_probability(&self, emitter: EmitterId) -> f32 {
        debug_assert!(emitter.index() < self.emitters.len());
        match &self.emitter_table {
            Some(table) => table.pmf(emitter.index()),
            None => 1.0 / self.emitters.len() as f32,
        }
    }

    /// A medium.
    #[inline]
    #[must_use]
    pub fn medium(&self, id: MediumId) -> &Medium {
        &self.media[id.index()]
    }

    /// The media on both sides of the shape that was hit, if it bounds any.
    #[inline]
    #[must_use]
    pub fn medium_interface(&self, surface: &SurfaceInteraction) -> Option<MediumInterface> {
        *self.medium_interfaces.get(surface.shape.index())?
    }

    /// The sensors, in the order of the file.
    #[must_use]
    pub fn sensors(&self) -> &[SensorSetup] {
        &self.sensors
    }

    /// The top-level triangle meshes, without those in groups.
    pub fn meshes(&self) -> impl Iterator<Item = &Mesh> {
        self.shapes[..self.top_level].iter().filter_map(|shape| match &shape.geometry {
            Geometry::Mesh(mesh) => Some(mesh),
            _ => None,
        })
    }

    /// The tree over all shapes. Scenes that differ elsewhere may share it.
    #[must_use]
    pub fn tree(&self) -> &Arc<Bvh> {
        &self.bvh
    }

    /// The bounds of the scene.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.bvh.bounds()
    }

    /// The hash of all inputs of the scene: its texts and all files that they name.
    #[must_use]
    pub fn content_hash(&self) -> [u8; 32] {
        self.hash
    }

    /// The closest hit with an analytic shape.
    fn intersect_shape(&self, id: ShapeId, primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        self.shapes[id.index()].geometry.intersect(primitive, ray)
    }

    /// The shape with the tree's index `geometry` in the group of `instance`.
    fn grouped_shape(&self, instance: u32, geometry: u32) -> ShapeId {
        let instance = &self.instances[instance as usize - self.top_level];
        ShapeId(self.groups[instance.group.index()].first_shape.0 + geometry)
    }

    /// Whether an analytic shape occludes the ray.
    fn occludes_shape(&self, id: ShapeId, primitive: u32, ray: &Ray) -> bool {
        self.shapes[id.index()].geometry.occludes(primitive, ray)
    }
}

impl SceneView for Scene {
    #[inline]
    fn shape(&self, id: ShapeId) -> &Shape {
        self.shape(id)
    }

    #[inline]
    fn textures(&self) -> Textures<'_> {
        self.textures()
    }

    fn bounds(&self) -> Bounds3 {
        self.bounds()
    }
}

impl Primitives for Scene {
    fn intersect(&self, geometry: u32, primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        self.intersect_shape(ShapeId(geometry), primitive, ray)
    }

    fn occludes(&self, geometry: u32, primitive: u32, ray: &Ray) -> bool {
        self.occludes_shape(ShapeId(geometry), primitive, ray)
    }

    fn intersect_in(
        &self,
        instance: u32,
        geometry: u32,
        primitive: u32,
        ray: &Ray,
    ) -> Option<PrimitiveHit> {
        self.intersect_shape(self.grouped_shape(instance, geometry), primitive, ray)
    }

    fn occludes_in(&self, instance: u32, geometry: u32, primitive: u32, ray: &Ray) -> bool {
        self.occludes_shape(self.grouped_shape(instance, geometry), primitive, ray)
    }
}
