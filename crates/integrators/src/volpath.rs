//! `volpath`: path tracing through participating media.

use crate::media::{Connection, Event, Heuristic, MediumWalk, Vertex, Weights};
use crate::path::{HIDE_EMITTERS, depths};
use crate::thin_sheet::ThinSheet;
use crate::{Integrator, Radiance, Start};
use etendue_document::Parameters;
use etendue_math::Ray;
use etendue_sampling::Sampler;
use etendue_scene::bsdf::{Bsdf, BsdfSample, Lobe, Transport};
use etendue_scene::emitter::DirectionSample;
use etendue_scene::phase::MediumInteraction;
use etendue_scene::{EmitterId, Hit, Manual, MediumId, ParameterManual, Scene, SurfaceInteraction};
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

/// What `volpath` and `volpathmis` read.
pub(crate) const PARAMETERS: [ParameterManual; 3] = [
    ParameterManual {
        name: "max_depth",
        kind: "integer",
        default: "-1",
        meaning: "The longest path, in edges: 1 shows emitters alone, 2 light that was scattered once, \
                  −1 has no limit. Surfaces that do not bend light end no edge.",
    },
    ParameterManual {
        name: "rr_depth",
        kind: "integer",
        default: "5",
        meaning: "Beyond this depth, paths end by Russian roulette.",
    },
    HIDE_EMITTERS,
];

/// The volumetric path tracer.
#[derive(Clone, Debug)]
pub struct VolumePath {
    /// The longest path, in edges.
    max_depth: u32,
    /// Beyond this depth, paths end by Russian roulette.
    rr_depth: u32,
    /// Whether the camera passes through emitters.
    hide_emitters: bool,
    /// Whether emitters are sampled; without, light is found by chance alone.
    emitter_sampling: bool,
    heuristic: Heuristic,
}

impl VolumePath {
    /// Reads `volpath`.
    #[must_use]
    pub fn build(parameters: &Parameters<'_>, emitter_sampling: bool) -> Self {
        Self::with_heuristic(parameters, emitter_sampling, Heuristic::Directions)
    }

    pub(crate) fn with_heuristic(
        parameters: &Parameters<'_>,
        emitter_sampling: bool,
        heuristic: Heuristic,
    ) -> Self {
        let (max_depth, rr_depth) = depths(parameters);
        Self {
            max_depth,
            rr_depth,
            hide_emitters: parameters.boolean("hide_emitters", false),
            emitter_sampling,
            heuristic,
        }
    }
}

/// A path on its way.
struct State {
    walk: MediumWalk,
    weights: Weights,
    /// The last vertex that scattered light.
    origin: Vec3,
    /// The index of refraction here relative to the camera's: light that will leave glass again is
    /// not lost to roulette for being compressed in it.
    eta: f32,
    /// The masked sheet that the path has just passed straight through.
    sheet: Option<ThinSheet>,
    /// Edges so far.
    depth: u32,
    radiance: Spectrum,
    alpha: f32,
}

/// The numbers of a vertex, used or not: what a path draws at a depth does not depend on what it met
/// before. They are those of `path`.
struct Numbers {
    emitter: Vec2,
    direction: Vec2,
    lobe: f32,
    roulette: f32,
}

impl Numbers {
    #[inline]
    fn draw(stream: &mut Sampler) -> Self {
        let (emitter, direction) = (stream.next_2d(), stream.next_2d());
        let Vec2 { x: lobe, y: roulette } = stream.next_independent_2d();
        Self { emitter, direction, lobe, roulette }
    }
}

impl Integrator for VolumePath {
    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        stream: &mut Sampler,
        _: &mut [f32],
    ) -> Radiance {
        let mut path = State {
            walk: MediumWalk::new(start.ray, start.medium, stream),
            weights: Weights::new(),
            origin: start.ray.origin,
            eta: 1.0,
            sheet: None,
            depth: 0,
            radiance: Spectrum::ZERO,
            alpha: 0.0,
        };
        while path.depth < self.max_depth {
            let goes_on = match path.walk.travel(scene, &mut path.weights) {
                Event::Surface(hit) => self.meet(scene, &mut path, &hit, stream),
                Event::Scattering(medium, point) => {
                    self.scatter(scene, &mut path, (medium, point), stream)
                }
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
        Radiance { color: path.radiance, alpha: path.alpha }
    }
}

impl VolumePath {
    /// The ray has left the scene.
    fn escape(&self, scene: &Scene, path: &mut State) {
        if self.hide_emitters && path.depth == 0 {
            return;
        }
        let direction = path.walk.ray.direction;
        for &emitter in scene.environments() {
            let radiance = scene.emitter(emitter).distant_radiance(direction);
            self.find(scene, path, (emitter, radiance), None);
        }
        if !self.hide_emitters && !scene.environments().is_empty() {
            path.alpha = 1.0;
        }
    }

    /// Counts light that the path has come upon.
    #[inline]
    fn find(
        &self,
        scene: &Scene,
        path: &mut State,
        (emitter, radiance): (EmitterId, Spectrum),
        surface: Option<&SurfaceInteraction>,
    ) {
        if radiance.is_black() {
            return;
        }
        let weight = path.weights.of_chance(self.heuristic, || {
            let direction = path.walk.ray.direction;
            let pdf = scene.emitter(emitter).pdf_direction(scene, path.origin, direction, surface);
            pdf * scene.emitter_probability(emitter)
        });
        path.radiance += path.weights.throughput * radiance * weight;
    }

    /// The path has met a surface; false where it ends.
    fn meet(&self, scene: &Scene, path: &mut State, hit: &Hit, stream: &mut Sampler) -> bool {
        let surface = scene.interaction(&path.walk.ray, hit);
        if path.sheet.as_mut().is_some_and(|sheet| sheet.holds(&surface)) {
            path.walk.leave(scene, &surface, path.walk.ray.direction);
            return true;
        }
        path.sheet = None;
        if let Some(emitter) = scene.emitter_of(&surface) {
            if self.hide_emitters && path.depth == 0 {
                path.walk.leave(scene, &surface, path.walk.ray.direction);
                return true;
            }
            let radiance = scene.emitter(emitter).surface_radiance(scene, &surface);
            self.find(scene, path, (emitter, radiance), Some(&surface));
        }
        let bsdf = scene.prepare_bsdf(&surface);
        let (share, probability) = bsdf.null_transmission(surface.wi);
        if probability == 1.0 {
            path.sheet = Some(ThinSheet::new(surface.shape, surface.point));
            path.weights.throughput *= share;
            path.walk.leave(scene, &surface, path.walk.ray.direction);
            return !path.weights.throughput.is_black();
        }
        let numbers = Numbers::draw(stream);
        if self.emitter_sampling && path.depth + 1 < self.max_depth && bsdf.has_smooth_lobe() {
            self.light_surface(scene, path, (&surface, &bsdf), numbers.emitter);
        }
        self.leave(scene, path, (&surface, &bsdf), &numbers)
            && self.survives(path, numbers.roulette)
    }

    /// Takes the next direction at a surface; false where there is none.
    fn leave(
        &self,
        scene: &Scene,
        path: &mut State,
        (surface, bsdf): (&SurfaceInteraction, &Bsdf<'_>),
        numbers: &Numbers,
    ) -> bool {
        let sample = bsdf.sample(surface.wi, numbers.lobe, numbers.direction, Transport::Radiance);
        let Some(BsdfSample { wo, weight, pdf, eta, lobe }) = sample else {
            path.alpha = 1.0;
            return false;
        };
        path.walk.leave(scene, surface, surface.to_world(wo));
        if lobe == Lobe::Null {
            path.sheet = Some(ThinSheet::new(surface.shape, surface.point));
            return path.weights.pass(weight, pdf);
        }
        path.alpha = 1.0;
        path.origin = surface.point;
        path.eta *= eta;
        path.depth += 1;
        path.weights.turn(weight, pdf, self.emitter_sampling && lobe.is_smooth());
        !path.weights.throughput.is_black()
    }

    /// Light that one emitter, chosen by chance, sends over a surface.
    fn light_surface(
        &self,
        scene: &Scene,
        path: &mut State,
        (surface, bsdf): (&SurfaceInteraction, &Bsdf<'_>),
        random: Vec2,
    ) {
        let Some(light) = scene.sample_light(surface.point, random) else { return };
        let wo = surface.to_local(light.direction);
        let (value, pdf) = bsdf.eval_pdf(surface.wi, wo, Transport::Radiance);
        self.connect(scene, path, Vertex::Surface(surface), (&light, value, pdf));
    }

    /// The path has collided with a medium; false where it ends.
    fn scatter(
        &self,
        scene: &Scene,
        path: &mut State,
        (medium, point): (MediumId, Vec3),
        stream: &mut Sampler,
    ) -> bool {
        path.alpha = 1.0;
        path.sheet = None;
        path.depth += 1;
        if path.depth >= self.max_depth {
            return false;
        }
        let medium = scene.medium(medium);
        let site = MediumInteraction { point, wi: -path.walk.ray.direction };
        let numbers = Numbers::draw(stream);
        let competes = self.emitter_sampling && medium.sample_emitters;
        if competes && let Some(light) = scene.sample_light(point, numbers.emitter) {
            let pdf = medium.phase.eval(&site, light.direction);
            self.connect(scene, path, Vertex::Inside(point), (&light, Spectrum::splat(pdf), pdf));
        }
        let Some(sample) = medium.phase.sample(&site, numbers.lobe, numbers.direction) else {
            return false;
        };
        path.weights.turn(Spectrum::ONE, sample.pdf, competes);
        path.origin = point;
        path.walk.ray = Ray::new(point, sample.wo);
        self.survives(path, numbers.roulette)
    }

    /// Next-event estimation: counts the light of an emitter, scattered with `value`, in a direction
    /// that scattering would have taken with density `pdf`.
    fn connect(
        &self,
        scene: &Scene,
        path: &mut State,
        vertex: Vertex<'_>,
        (light, value, pdf): (&DirectionSample, Spectrum, f32),
    ) {
        let contribution = path.weights.throughput * value * light.radiance;
        if contribution.is_black() {
            return;
        }
        let connection = Connection::new(scene, vertex, light, &mut path.walk);
        let Some(Connection { transmittance, unidirectional_pdf }) = connection else { return };
        let chance = if light.delta { 0.0 } else { pdf };
        let weight =
            path.weights.of_connection(self.heuristic, light.pdf, chance, unidirectional_pdf);
        path.radiance += contribution * transmittance * (weight / light.pdf);
    }

    /// Russian roulette: paths that carry little end early, and the survivors stand for them. As in
    /// Mitsuba, it begins one edge later than that of `path`.
    fn survives(&self, path: &mut State, random: f32) -> bool {
        if path.depth <= self.rr_depth {
            return true;
        }
        let throughput = &mut path.weights.throughput;
        let probability = (throughput.max_component() * path.eta * path.eta).min(0.95);
        if random >= probability {
            return false;
        }
        *throughput *= 1.0 / probability;
        true
    }
}
