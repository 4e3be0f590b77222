//! Vertices that are shaded together, one per lane.

use super::step::{NextVertex, PathState, Step};
use crate::estimator::{
    Continuation, LaneScattering, PathVertex, PathWeight, ProposedLight, ShadingPoint,
    VertexNumbers,
};
use etendue_math::lanes::{LaneArray, LaneMask, Lanes, Level, MAX_LANES, Mask, Simd, Vector3};
use etendue_math::{Ray, RayLanes, with_lanes};
use etendue_sampling::{RandomBatch, draw_vertices};
use etendue_scene::models::mesh::TriangleBatch;
use etendue_scene::{
    ClosureBatch, Hit, LaneKind, MaterialId, Scene, ShapeId, SurfaceBatch, SurfaceLanes,
};
use etendue_spectrum::{Spectrum, SpectrumLanes};

/// As many vertices as the widest SIMD registers hold, all with materials of one kind, and how
/// their paths continue. A place is a vertex's index in the batch.
pub(super) struct Batch<'a> {
    /// The path in the wavefront that each vertex belongs to.
    pub(super) paths: [usize; MAX_LANES],
    /// The number of places in use, counted from the first.
    count: usize,
    /// The kind of the vertices' materials.
    kind: LaneKind,
    pub(super) triangles: TriangleBatch,
    pub(super) surfaces: SurfaceBatch,
    closures: ClosureBatch<'a>,
    numbers: RandomBatch,
    /// The path weights: on arrival, and after [`scatter`](Self::scatter) on departure.
    throughput: [LaneArray; Spectrum::LANES],
    eta: LaneArray,
    pending: PendingLight,
    next: NextRays,
}

/// Pending light, which arrives if it is not occluded.
#[derive(Default)]
struct PendingLight {
    /// A bit for each place with pending light.
    places: u32,
    radiance: [LaneArray; Spectrum::LANES],
    /// The shadow rays.
    origin: [LaneArray; 3],
    direction: [LaneArray; 3],
    t_max: LaneArray,
}

/// How paths continue.
#[derive(Default)]
struct NextRays {
    /// A bit for each place whose path continues.
    places: u32,
    /// A bit for each place whose direction competes with next-event estimation.
    competing: u32,
    /// A bit for each place with null transmission.
    null: u32,
    origin: [LaneArray; 3],
    direction: [LaneArray; 3],
    /// The density of the direction.
    pdf: LaneArray,
}

/// The vertices from one place on that fill the machine's lanes.
#[derive(Clone, Copy)]
struct LaneGroup<S: Simd> {
    simd: S,
    /// The first place.
    first: usize,
    surface: SurfaceLanes<Lanes<S>>,
    point: ShadingPoint<Lanes<S>>,
    /// Which lanes hold a vertex whose path is scattered.
    live: LaneMask<S>,
}

impl<'a> Batch<'a> {
    pub(super) fn new() -> Self {
        Self {
            paths: [0; MAX_LANES],
            count: 0,
            kind: LaneKind::Diffuse,
            triangles: TriangleBatch::default(),
            surfaces: SurfaceBatch::default(),
            closures: ClosureBatch::new(LaneKind::Diffuse),
            numbers: RandomBatch::default(),
            throughput: Default::default(),
            eta: LaneArray::ZERO,
            pending: PendingLight::default(),
            next: NextRays::default(),
        }
    }

    /// Makes room for `count` vertices of another kind.
    pub(super) fn start(&mut self, kind: LaneKind, count: usize) {
        (self.kind, self.count) = (kind, count);
        self.closures.restart(kind);
    }

    /// Sets the path of a place and its weight.
    #[inline(always)]
    pub(super) fn set_path(&mut self, place: usize, index: usize, path: &PathState) {
        self.paths[place] = index;
        SpectrumLanes::from(path.throughput).put(&mut self.throughput, place);
        self.eta.0[place] = path.eta;
    }

    /// Resolves the material at a place whose surface is known.
    #[inline(always)]
    pub(super) fn set_material(
        &mut self,
        scene: &'a Scene,
        place: usize,
        material: MaterialId,
        hit: &Hit,
    ) {
        let materials = scene.materials();
        if materials.is_uniform(material) {
            self.closures.set_uniform(place, materials, material);
        } else {
            let surface = self.surfaces.interaction(place, hit);
            self.closures.set(place, materials, material, scene.textures(), &surface);
        }
    }

    /// Draws the random numbers of the vertices.
    pub(super) fn draw(&mut self, level: Level, paths: &mut [PathState]) {
        let Self { paths: chosen, count, numbers, .. } = self;
        let chosen = chosen[..*count].iter().copied();
        with_lanes!(level, simd => {
            draw_vertices(simd, paths, chosen, #[inline(always)] |path| &mut path.sampler, numbers)
        });
    }

    /// Computes the surfaces of the triangles.
    pub(super) fn find_surfaces(&mut self, level: Level) {
        with_lanes!(level, simd => self.find_surfaces_with(simd));
    }

    #[inline(always)]
    fn find_surfaces_with<S: Simd>(&mut self, simd: S) {
        for first in (0..self.count).step_by(Lanes::<S>::COUNT) {
            self.surfaces.store(&self.triangles.surfaces(simd, first), first);
        }
    }

    /// Samples light for the vertices.
    pub(super) fn propose_light(&mut self, step: Step<'_>) {
        self.pending.places = 0;
        if step.parameters.emitter_sampling && self.kind.has_smooth_lobe() {
            with_lanes!(step.scene.level(), simd => {
                for first in (0..self.count).step_by(self.width(simd)) {
                    self.propose_light_to(self.group(simd, first, step), step);
                }
            });
        }
    }

    /// Samples how the paths continue.
    pub(super) fn scatter(&mut self, step: Step<'_>) {
        self.next.places = 0;
        self.next.competing = 0;
        self.next.null = 0;
        with_lanes!(step.scene.level(), simd => {
            for first in (0..self.count).step_by(self.width(simd)) {
                self.scatter_group(self.group(simd, first, step), step);
            }
        });
    }

    /// The number of vertices in a group.
    #[inline(always)]
    fn width<S: Simd>(&self, _: S) -> usize {
        Lanes::<S>::COUNT
    }

    /// The vertices starting at place `first`.
    #[inline(always)]
    fn group<S: Simd>(&self, simd: S, first: usize, step: Step<'_>) -> LaneGroup<S> {
        let surface = self.surfaces.load(simd, first);
        let taken = LaneMask::from_bits(simd, ((1_u64 << (self.count - first)) - 1) as u32);
        let directions = self.triangles.directions(simd, first);
        let point = ShadingPoint::from(&surface);
        let live = step.parameters.strict_normals.cut_arrivals(taken, &point, directions);
        LaneGroup { simd, first, surface, point, live }
    }

    #[inline(always)]
    fn propose_light_to<S: Simd>(&mut self, group: LaneGroup<S>, step: Step<'_>) {
        let LaneGroup { simd, first, surface, point, live } = group;
        let random = VertexNumbers::load(simd, &self.numbers, first).light;
        let light = step.scene.sample_lights(simd, surface.point, random, live);
        if !light.exists.any() {
            return;
        }
        let scattering = LaneScattering { closures: &self.closures, simd, first };
        let reflected = step.next_event().reflect(&point, &scattering, &(&light).into());
        let throughput = SpectrumLanes::load(simd, &self.throughput, first);
        let RayLanes { origin, direction, t_max } = light.shadow_rays(&surface);
        let pending = &mut self.pending;
        (throughput * reflected.radiance).store(&mut pending.radiance, first);
        origin.store(&mut pending.origin, first);
        direction.store(&mut pending.direction, first);
        t_max.store(&mut pending.t_max, first);
        pending.places |= reflected.exists.bits() << first;
    }

    #[inline(always)]
    fn scatter_group<S: Simd>(&mut self, group: LaneGroup<S>, step: Step<'_>) {
        let LaneGroup { simd, first, surface, point, live } = group;
        let numbers = VertexNumbers::load(simd, &self.numbers, first);
        let weight = PathWeight {
            throughput: SpectrumLanes::load(simd, &self.throughput, first),
            eta: Lanes::load(simd, &self.eta, first),
        };
        let scattering = LaneScattering { closures: &self.closures, simd, first };
        let strict_normals = step.parameters.strict_normals;
        let mut continuation =
            Continuation::sample(&point, &scattering, weight, &numbers.scatter, strict_normals);
        if step.plays_roulette() {
            continuation.play_roulette(numbers.roulette);
        }
        let Continuation { exists, null, smooth, direction, pdf, weight } = continuation;
        weight.throughput.store(&mut self.throughput, first);
        weight.eta.store(&mut self.eta, first);
        let next = &mut self.next;
        surface.ray_origin(direction).store(&mut next.origin, first);
        direction.store(&mut next.direction, first);
        pdf.store(&mut next.pdf, first);
        next.places |= (live & exists).bits() << first;
        if step.parameters.emitter_sampling {
            next.competing |= smooth.bits() << first;
        }
        next.null |= (live & null).bits() << first;
    }

    /// The places with pending light.
    pub(super) fn lit_places(&self) -> impl Iterator<Item = usize> + use<> {
        places(self.pending.places)
    }

    /// The pending light of a place, as it reaches the camera.
    #[inline(always)]
    pub(super) fn proposed_light(&self, place: usize) -> ProposedLight {
        let pending = &self.pending;
        let shadow_ray = Ray::segment(
            Vector3::take(&pending.origin, place).into(),
            Vector3::take(&pending.direction, place).into(),
            pending.t_max.0[place],
        );
        let radiance = SpectrumLanes::take(&pending.radiance, place).into();
        ProposedLight { shadow_ray, radiance }
    }

    /// The random number that selected the light of a place.
    #[inline(always)]
    pub(super) fn light_choice(&self, place: usize) -> f32 {
        self.numbers.light[0].0[place]
    }

    /// The places whose paths end or are scattered, without those of null transmission.
    pub(super) fn covered_places(&self) -> impl Iterator<Item = usize> + use<> {
        places(((1_u64 << self.count) - 1) as u32 & !self.next.null)
    }

    /// The places whose paths continue.
    pub(super) fn next_places(&self) -> impl Iterator<Item = usize> + use<> {
        places(self.next.places)
    }

    /// How the path of a place continues; its vertex lies on `shape`.
    #[inline(always)]
    pub(super) fn next_vertex(&self, place: usize, shape: ShapeId) -> NextVertex {
        let next = &self.next;
        let competes = next.competing >> place & 1 != 0;
        NextVertex {
            ray: Ray::new(
                Vector3::take(&next.origin, place).into(),
                Vector3::take(&next.direction, place).into(),
            ),
            vertex: PathVertex {
                point: self.surfaces.point(place),
                pdf: competes.then_some(next.pdf.0[place]),
            },
            shape,
            throughput: SpectrumLanes::take(&self.throughput, place).into(),
            eta: self.eta.0[place],
            null: next.null >> place & 1 != 0,
        }
    }
}

/// The places whose bits are set.
pub(super) fn places(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (place < u32::BITS).then_some(place as usize)
    })
}
