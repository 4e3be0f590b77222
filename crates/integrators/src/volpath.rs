//! `volpath`: path tracing through participating media.

use crate::estimator::{Alpha, Emission, Roulette, ThinSheet, VertexNumbers};
use crate::integrator::{Integrator, Radiance, Start};
use crate::media::{Connection, Event, Heuristic, MediumVertex, MediumWalk, Turn, Vertex, Weights};
use crate::options::IntegratorOptions;
use crate::parameters::{CLAMP_INDIRECT, HIDE_EMITTERS, MAX_DEPTH, PathParameters, RR_DEPTH};
use crate::watch::{Watch, WorkLimit};
use etendue_document::Parameters;
use etendue_math::Ray;
use etendue_sampling::Sampler;
use etendue_scene::bsdf::{Bsdf, BsdfSample, Lobe, Transport};
use etendue_scene::emitter::DirectionSample;
use etendue_scene::phase::MediumInteraction;
use etendue_scene::{Hit, Manual, ParameterManual, Scene, SurfaceInteraction};
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "Path tracing through participating media. On surfaces it does what `path` does; in media \
              it follows real and imaginary collisions (delta tracking). Light that is sampled on \
              emitters passes media and surfaces that do not bend it: `null`, `thindielectric`, masks. \
              Colours whose extinction differs are weighed against each other over the whole path.",
    parameters: &PARAMETERS,
    sample: r#"<integrator type="volpath"><integer name="max_depth" value="8"/></integrator>"#,
};

/// The parameters of `volpath` and `volpathmis`.
pub(crate) const PARAMETERS: [ParameterManual; 4] = [
    ParameterManual {
        meaning: "The longest path, in edges: 1 shows emitters alone, 2 light that was scattered once, \
                  −1 has no limit but 65,536. Surfaces that do not bend light end no edge.",
        ..MAX_DEPTH
    },
    ParameterManual { meaning: "Beyond this depth, paths end by Russian roulette.", ..RR_DEPTH },
    HIDE_EMITTERS,
    CLAMP_INDIRECT,
];

/// The volumetric path tracer.
#[derive(Clone, Debug)]
pub struct VolumePath {
    parameters: PathParameters,
    heuristic: Heuristic,
}

impl VolumePath {
    /// Reads `volpath`.
    #[must_use]
    pub fn build(parameters: &Parameters<'_>, options: &IntegratorOptions) -> Self {
        Self::with_heuristic(parameters, options, Heuristic::Directions)
    }

    pub(crate) fn with_heuristic(
        parameters: &Parameters<'_>,
        options: &IntegratorOptions,
        heuristic: Heuristic,
    ) -> Self {
        Self { parameters: PathParameters::read(parameters, options), heuristic }
    }
}

/// The state of a path.
struct State<'a> {
    walk: MediumWalk<'a>,
    weights: Weights,
    /// The last vertex that scattered light.
    vertex: Vec3,
    /// The index of refraction here relative to the camera's; see [`Roulette::play`].
    eta: f32,
    sheet: ThinSheet,
    /// The number of edges so far.
    depth: u32,
    radiance: Spectrum,
    alpha: Alpha,
}

/// A surface hit of a path.
struct SurfaceVertex<'a> {
    surface: &'a SurfaceInteraction,
    bsdf: &'a Bsdf<'a>,
}

/// Light of an emitter that a vertex scatters back along the path.
struct ScatteredLight<'a> {
    light: &'a DirectionSample,
    /// The scattered fraction of the light.
    value: Spectrum,
    /// The density with which scattering would have sampled the light's direction.
    scatter_pdf: f32,
}

impl Integrator for VolumePath {
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
        let mut edges = WorkLimit::edges(watch);
        let mut path = State {
            walk: MediumWalk::new(start, sampler, watch),
            weights: Weights::new(),
            vertex: start.ray.origin,
            eta: 1.0,
            sheet: ThinSheet::default(),
            depth: 0,
            radiance: Spectrum::ZERO,
            alpha: Alpha::default(),
        };
        while path.depth < self.parameters.limits.max_depth && edges.step() {
            let goes_on = match path.walk.advance(scene, &mut path.weights) {
                Event::Surface(hit) => self.meet_surface(scene, &mut path, &hit, sampler),
                Event::Scattering(vertex) => self.scatter(scene, &mut path, vertex, sampler),
                Event::Escape => {
                    self.escape(scene, &mut path);
                    false
                }
                Event::End => false,
            };
            if !goes_on {
                break;
            }
        }
        Radiance { color: path.radiance, alpha: path.alpha.value() }
    }
}

impl VolumePath {
    /// Handles a ray that has left the scene.
    fn escape(&self, scene: &Scene, path: &mut State<'_>) {
        if self.parameters.hide_emitters.seen_by(path.alpha).0 {
            return;
        }
        for emission in Emission::from_afar(scene, path.walk.ray.direction) {
            self.add_emission(scene, path, &emission);
        }
        path.alpha.escape(scene, self.parameters.hide_emitters);
    }

    /// Adds light that the path has hit.
    #[inline]
    fn add_emission(&self, scene: &Scene, path: &mut State<'_>, emission: &Emission<'_>) {
        let weight = path.weights.of_emission(self.heuristic, || {
            emission.next_event_pdf(scene, path.vertex, path.walk.ray.direction)
        });
        let light = path.weights.throughput * emission.radiance * weight;
        path.radiance += self.parameters.clamp_indirect.apply(light, path.depth);
    }

    /// Handles a surface hit; false if the path ends.
    fn meet_surface(
        &self,
        scene: &Scene,
        path: &mut State<'_>,
        hit: &Hit,
        sampler: &mut Sampler,
    ) -> bool {
        let surface = scene.interaction(&path.walk.ray, hit);
        let hide_emitters = self.parameters.hide_emitters.seen_by(path.alpha);
        if path.sheet.holds(&surface) || hide_emitters.hides(scene, &surface) {
            path.walk.leave(scene, &surface, path.walk.ray.direction);
            return true;
        }
        if let Some(emission) = Emission::of_surface(scene, &surface) {
            self.add_emission(scene, path, &emission);
        }
        let bsdf = scene.prepare_bsdf(&surface);
        let (share, probability) = bsdf.null_transmission(surface.wi);
        if probability == 1.0 {
            path.sheet.enter(surface.shape, surface.point);
            path.weights.throughput *= share;
            path.walk.leave(scene, &surface, path.walk.ray.direction);
            return !path.weights.throughput.is_black();
        }
        let vertex = SurfaceVertex { surface: &surface, bsdf: &bsdf };
        let numbers = VertexNumbers::draw(sampler);
        let is_last = path.depth + 1 >= self.parameters.limits.max_depth;
        if self.parameters.emitter_sampling && !is_last && bsdf.has_smooth_lobe() {
            self.light_surface(scene, path, &vertex, numbers.light.into());
        }
        self.leave_surface(scene, path, &vertex, &numbers) && self.survives(path, numbers.roulette)
    }

    /// Samples the next direction at a surface; false if there is none.
    fn leave_surface(
        &self,
        scene: &Scene,
        path: &mut State<'_>,
        vertex: &SurfaceVertex<'_>,
        numbers: &VertexNumbers<f32>,
    ) -> bool {
        let SurfaceVertex { surface, bsdf } = vertex;
        let (lobe, direction) = (numbers.scatter.lobe, numbers.scatter.direction.into());
        let sample = bsdf.sample(surface.wi, lobe, direction, Transport::Radiance);
        let Some(BsdfSample { wo, weight, pdf, eta, lobe }) = sample else {
            path.alpha.cover();
            return false;
        };
        path.walk.leave(scene, surface, surface.to_world(wo));
        if lobe == Lobe::Null {
            path.sheet.enter(surface.shape, surface.point);
            return path.weights.pass_straight(weight, pdf);
        }
        path.alpha.cover();
        path.vertex = surface.point;
        path.eta *= eta;
        path.depth += 1;
        let competes = self.parameters.emitter_sampling && lobe.is_smooth();
        path.weights.turn(&Turn { weight, pdf, competes });
        !path.weights.throughput.is_black()
    }

    /// Light from one randomly chosen emitter, scattered at a surface.
    fn light_surface(
        &self,
        scene: &Scene,
        path: &mut State<'_>,
        vertex: &SurfaceVertex<'_>,
        random: Vec2,
    ) {
        let SurfaceVertex { surface, bsdf } = vertex;
        let Some(light) = scene.sample_light(surface.point, random) else { return };
        let wo = surface.to_local(light.direction);
        let (value, scatter_pdf) = bsdf.eval_pdf(surface.wi, wo, Transport::Radiance);
        let scattered = ScatteredLight { light: &light, value, scatter_pdf };
        self.connect(scene, path, Vertex::Surface(surface), &scattered);
    }

    /// Handles a collision in a medium; false if the path ends.
    fn scatter(
        &self,
        scene: &Scene,
        path: &mut State<'_>,
        vertex: MediumVertex,
        sampler: &mut Sampler,
    ) -> bool {
        path.alpha.cover();
        path.sheet.leave();
        path.depth += 1;
        if path.depth >= self.parameters.limits.max_depth {
            return false;
        }
        let medium = scene.medium(vertex.medium);
        let point = vertex.point;
        let interaction = MediumInteraction { point, wi: -path.walk.ray.direction };
        let numbers = VertexNumbers::draw(sampler);
        let competes = self.parameters.emitter_sampling && medium.sample_emitters;
        if competes && let Some(light) = scene.sample_light(point, numbers.light.into()) {
            let scatter_pdf = medium.phase.eval(&interaction, light.direction);
            let value = Spectrum::splat(scatter_pdf);
            let scattered = ScatteredLight { light: &light, value, scatter_pdf };
            self.connect(scene, path, Vertex::Medium(point), &scattered);
        }
        let (lobe, direction) = (numbers.scatter.lobe, numbers.scatter.direction.into());
        let Some(sample) = medium.phase.sample(&interaction, lobe, direction) else {
            return false;
        };
        path.weights.turn(&Turn { weight: Spectrum::ONE, pdf: sample.pdf, competes });
        path.vertex = point;
        path.walk.ray = Ray::new(point, sample.wo);
        self.survives(path, numbers.roulette)
    }

    /// Next-event estimation: adds an emitter's light that a vertex scatters.
    fn connect(
        &self,
        scene: &Scene,
        path: &mut State<'_>,
        vertex: Vertex<'_>,
        scattered: &ScatteredLight<'_>,
    ) {
        let ScatteredLight { light, value, scatter_pdf } = *scattered;
        let contribution = path.weights.throughput * value * light.radiance;
        if contribution.is_black() {
            return;
        }
        let connection = Connection::new(scene, vertex, light, &mut path.walk);
        let Some(connection) = connection else { return };
        let weight = path.weights.of_connection(
            self.heuristic,
            light,
            scatter_pdf,
            connection.unidirectional_pdf,
        );
        let light = contribution * connection.transmittance * (weight / light.pdf);
        let scattering_count = match vertex {
            Vertex::Surface(_) => path.depth + 1,
            // The collision has already been counted.
            Vertex::Medium(_) => path.depth,
        };
        path.radiance += self.parameters.clamp_indirect.apply(light, scattering_count);
    }

    /// Russian roulette. As in Mitsuba, it begins one edge later than in `path`.
    fn survives(&self, path: &mut State<'_>, random: f32) -> bool {
        if path.depth <= self.parameters.limits.rr_depth {
            return true;
        }
        let throughput = &mut path.weights.throughput;
        let Roulette { survives, gain } =
            Roulette::play(throughput.max_component(), path.eta, random);
        *throughput *= gain;
        survives
    }
}
