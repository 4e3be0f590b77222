//! Vertices that are shaded together, one to a lane.

use super::Path;
use super::wavefront::{PendingContribution, State, roulette};
use crate::light::{Origin, power_heuristic};
use etendue_math::lanes::{
    LaneArray, LaneMask, Lanes, Level, MAX_LANES, Mask, Real, Simd, Vector2, Vector3,
};
use etendue_math::{Ray, RayLanes, with_lanes};
use etendue_sampling::{RandomBatch, draw_vertices};
use etendue_scene::bsdf::{ClosureLanes, LaneKind, SampleLanes};
use etendue_scene::models::mesh::TriangleBatch;
use etendue_scene::{Hit, MaterialId, Scene, SurfaceBatch, SurfaceLanes};
use etendue_spectrum::{Spectrum, SpectrumLanes};

/// As many vertices as the widest lanes take, all of materials of one kind, and where their paths go
/// on. A place is a vertex's number in the block.
pub(super) struct Batch<'a> {
    /// Which of the wave's paths stand at the vertices.
    pub(super) paths: [usize; MAX_LANES],
    /// How many of the places are taken, from the first on.
    count: usize,
    /// What kind of materials the vertices have.
    kind: LaneKind,
    pub(super) triangles: TriangleBatch,
    pub(super) surfaces: SurfaceBatch,
    closures: ClosureLanes<'a>,
    numbers: RandomBatch,
    /// What of the light found from here on arrives at the camera; then of that found after the next.
    throughput: [LaneArray; Spectrum::LANES],
    /// The index of refraction relative to the camera's, likewise.
    eta: LaneArray,
    pending: PendingContributions,
    next: NextRays,
}

/// Light that arrives if nothing stands between.
#[derive(Default)]
struct PendingContributions {
    /// A bit for each place that has some.
    places: u32,
    radiance: [LaneArray; Spectrum::LANES],
    /// The shadow rays.
    origin: [LaneArray; 3],
    direction: [LaneArray; 3],
    t_max: LaneArray,
}

/// Where paths go on.
#[derive(Default)]
struct NextRays {
    /// A bit for each place whose path does.
    places: u32,
    /// A bit for each place whose direction competes with next-event estimation.
    competing: u32,
    /// A bit for each place whose path goes straight on, as if no surface were there.
    straight: u32,
    origin: [LaneArray; 3],
    direction: [LaneArray; 3],
    /// The density of the direction.
    pdf: LaneArray,
}

/// What a block's paths have in common.
#[derive(Clone, Copy)]
pub(super) struct Stage<'a> {
    pub(super) integrator: &'a Path,
    pub(super) scene: &'a Scene,
    /// Edges of the paths so far.
    pub(super) depth: u32,
}

/// How a path goes on.
pub(super) struct Continuation {
    /// Where in the block its vertex is.
    pub(super) place: usize,
    /// Which of the wave's paths.
    pub(super) path: usize,
    pub(super) ray: Ray,
    /// The vertex that it leaves.
    pub(super) origin: Origin,
    pub(super) throughput: Spectrum,
    pub(super) eta: f32,
    /// Whether it passes straight through the surface, as if that were not there.
    pub(super) straight: bool,
}

impl<'a> Batch<'a> {
    pub(super) fn new() -> Self {
        Self {
            paths: [0; MAX_LANES],
            count: 0,
            kind: LaneKind::Diffuse,
            triangles: TriangleBatch::default(),
            surfaces: SurfaceBatch::default(),
            closures: ClosureLanes::new(LaneKind::Diffuse),
            numbers: RandomBatch::default(),
            throughput: Default::default(),
            eta: LaneArray::ZERO,
            pending: PendingContributions::default(),
            next: NextRays::default(),
        }
    }

    /// Makes room for `count` vertices of another kind.
    pub(super) fn start(&mut self, kind: LaneKind, count: usize) {
        (self.kind, self.count) = (kind, count);
        self.closures.restart(kind);
    }

    /// Says which path stands in a place, and what it carries.
    #[inline(always)]
    pub(super) fn set_path(
        &mut self,
        place: usize,
        path: usize,
        (throughput, eta): (Spectrum, f32),
    ) {
        self.paths[place] = path;
        SpectrumLanes::from(throughput).put(&mut self.throughput, place);
        self.eta.0[place] = eta;
    }

    /// Resolves the material in a place, whose surface has been found.
    #[inline(always)]
    pub(super) fn set_material(
        &mut self,
        scene: &'a Scene,
        place: usize,
        (material, hit): (MaterialId, &Hit),
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
    pub(super) fn draw(&mut self, level: Level, paths: &mut [State]) {
        let Self { paths: chosen, count, numbers, .. } = self;
        let chosen = chosen[..*count].iter().copied();
        with_lanes!(level, simd => {
            draw_vertices(simd, paths, chosen, #[inline(always)] |path| &mut path.stream, numbers)
        });
    }

    /// Finds the surfaces of the triangles.
    pub(super) fn arrive(&mut self, scene: &Scene) {
        with_lanes!(scene.level(), simd => self.arrive_with(simd));
    }

    #[inline(always)]
    fn arrive_with<S: Simd>(&mut self, simd: S) {
        for first in (0..self.count).step_by(Lanes::<S>::COUNT) {
            self.surfaces.store(&self.triangles.surfaces(simd, first), first);
        }
    }

    /// Chooses light, and where the paths go on.
    pub(super) fn shade(&mut self, stage: Stage<'_>) {
        with_lanes!(stage.scene.level(), simd => self.shade_with(simd, stage));
    }

    #[inline(always)]
    fn shade_with<S: Simd>(&mut self, simd: S, stage: Stage<'_>) {
        self.pending.places = 0;
        self.next.places = 0;
        self.next.competing = 0;
        self.next.straight = 0;
        for first in (0..self.count).step_by(Lanes::<S>::COUNT) {
            let surface = self.surfaces.load(simd, first);
            let mut live = LaneMask::from_bits(simd, ((1_u64 << (self.count - first)) - 1) as u32);
            if stage.integrator.strict_normals {
                let directions = self.triangles.directions(simd, first);
                live = live & (surface.normal.dot(directions) * surface.wi.z).below(0.0);
            }
            if stage.integrator.emitter_sampling && self.kind.has_smooth_lobe() {
                self.light(simd, stage, first, (&surface, live));
            }
            self.scatter(simd, stage, first, (&surface, live));
        }
    }

    /// Proposes light to the vertices from the place `first` on.
    #[inline(always)]
    fn light<S: Simd>(
        &mut self,
        simd: S,
        stage: Stage<'_>,
        first: usize,
        (surface, live): (&SurfaceLanes<Lanes<S>>, LaneMask<S>),
    ) {
        let random = Vector2::load(simd, &self.numbers.light, first);
        let light = stage.scene.sample_lights(simd, surface.point, random, live);
        if !light.exists.any() {
            return;
        }
        let wo = surface.shading.to_local(light.direction);
        let (value, scatter_pdf) = self.closures.eval_pdf(simd, first, surface.wi, wo);
        let contribution = value * light.radiance;
        let mut exists = light.exists & !contribution.is_black();
        if stage.integrator.strict_normals {
            exists = exists & (light.direction.dot(surface.normal) * wo.z).above(0.0);
        }
        let shared = power_heuristic(light.pdf, scatter_pdf);
        let weight = Lanes::select(light.delta, light.pdf.like(1.0), shared);
        let radiance = contribution * (weight / light.pdf);
        let throughput = SpectrumLanes::load(simd, &self.throughput, first);
        let RayLanes { origin, direction, t_max } = light.shadow_rays(surface);
        let pending = &mut self.pending;
        (throughput * radiance).store(&mut pending.radiance, first);
        origin.store(&mut pending.origin, first);
        direction.store(&mut pending.direction, first);
        t_max.store(&mut pending.t_max, first);
        pending.places |= exists.bits() << first;
    }

    /// Chooses the next directions of the paths from the place `first` on.
    #[inline(always)]
    fn scatter<S: Simd>(
        &mut self,
        simd: S,
        stage: Stage<'_>,
        first: usize,
        (surface, live): (&SurfaceLanes<Lanes<S>>, LaneMask<S>),
    ) {
        let Stage { integrator, depth, .. } = stage;
        let numbers = &self.numbers;
        let [lobe, ending] =
            [0, 1].map(|number| Lanes::load(simd, &numbers.choices[number], first));
        let random = Vector2::load(simd, &numbers.direction, first);
        let sample = self.closures.sample(simd, first, surface.wi, lobe, random);
        let SampleLanes { wo, weight, pdf, eta, exists, smooth, straight } = sample;
        let direction = surface.shading.to_world(wo);
        let mut throughput = SpectrumLanes::load(simd, &self.throughput, first) * weight;
        let eta = Lanes::load(simd, &self.eta, first) * eta;
        let mut goes_on = live & exists & !throughput.is_black();
        if integrator.strict_normals {
            let agrees = (direction.dot(surface.normal) * wo.z).above(0.0);
            goes_on = goes_on & (straight | agrees);
        }
        if depth + 1 >= integrator.rr_depth {
            let (survives, gain) = roulette(throughput, eta, ending);
            goes_on = goes_on & survives;
            throughput = throughput * gain;
        }
        throughput.store(&mut self.throughput, first);
        eta.store(&mut self.eta, first);
        let next = &mut self.next;
        surface.ray_origin(direction).store(&mut next.origin, first);
        direction.store(&mut next.direction, first);
        pdf.store(&mut next.pdf, first);
        next.places |= goes_on.bits() << first;
        if integrator.emitter_sampling {
            next.competing |= smooth.bits() << first;
        }
        next.straight |= straight.bits() << first;
    }

    /// The light that was proposed, the random numbers that chose it, and the rays that must be free.
    pub(super) fn pending_contributions(
        &self,
    ) -> impl Iterator<Item = (PendingContribution, f32, Ray)> + '_ {
        let pending = &self.pending;
        places(pending.places).map(|place| {
            let ray = Ray::segment(
                Vector3::take(&pending.origin, place).into(),
                Vector3::take(&pending.direction, place).into(),
                pending.t_max.0[place],
            );
            let radiance: Spectrum = SpectrumLanes::take(&pending.radiance, place).into();
            (
                PendingContribution { path: self.paths[place], radiance },
                self.numbers.light[0].0[place],
                ray,
            )
        })
    }

    /// How the paths that do go on.
    pub(super) fn continuations(&self) -> impl Iterator<Item = Continuation> + '_ {
        let next = &self.next;
        places(next.places).map(move |place| Continuation {
            path: self.paths[place],
            ray: Ray::new(
                Vector3::take(&next.origin, place).into(),
                Vector3::take(&next.direction, place).into(),
            ),
            origin: Origin {
                point: self.surfaces.point(place),
                pdf: (next.competing >> place & 1 != 0).then_some(next.pdf.0[place]),
            },
            throughput: SpectrumLanes::take(&self.throughput, place).into(),
            eta: self.eta.0[place],
            straight: next.straight >> place & 1 != 0,
            place,
        })
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
