//! Connections to emitters: the transmittance through media and null surfaces.

use super::walk::{MediumWalk, Tentative, medium_beyond, transmittance};
use crate::estimator::ThinSheet;
use etendue_math::{Ray, offset_ray_origin};
use etendue_scene::emitter::DirectionSample;
use etendue_scene::medium::{Density, Heterogeneous, Medium};
use etendue_scene::phase::MediumInteraction;
use etendue_scene::{MediumId, Scene, SurfaceInteraction};
use etendue_spectrum::Spectrum;
use glam::Vec3;

/// The vertex that receives the light.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Vertex<'a> {
    /// In a medium.
    Medium(Vec3),
    /// On a surface.
    Surface(&'a SurfaceInteraction),
}

/// What a connection between a vertex and an emitter transmits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Connection {
    /// An unbiased estimate of the transmitted fraction of light.
    pub(crate) transmittance: Spectrum,
    /// For each channel, the density with which a path that samples distances for this channel
    /// would pass here, relative to the density of the connection.
    pub(crate) unidirectional_pdf: Spectrum,
}

/// A connection that is being traced.
struct Tracer<'a, 'w> {
    walk: &'a mut MediumWalk<'w>,
    connection: Connection,
    sheet: ThinSheet,
}

impl Vertex<'_> {
    /// Where a ray towards `direction` starts.
    fn origin(&self, direction: Vec3) -> Vec3 {
        match self {
            Self::Medium(point) => *point,
            Self::Surface(surface) => {
                offset_ray_origin(surface.point, surface.error, surface.normal, direction)
            }
        }
    }
}

impl Connection {
    /// Connects a vertex to a light; `None` if no light is transmitted.
    pub(crate) fn new(
        scene: &Scene,
        vertex: Vertex<'_>,
        light: &DirectionSample,
        walk: &mut MediumWalk<'_>,
    ) -> Option<Self> {
        let mut medium = match vertex {
            Vertex::Medium(_) => walk.medium,
            Vertex::Surface(surface) => medium_beyond(scene, surface, light.direction, walk.medium),
        };
        let mut ray = light.shadow_ray_from(vertex.origin(light.direction));
        let connection = Self { transmittance: Spectrum::ONE, unidirectional_pdf: Spectrum::ONE };
        let mut tracer = Tracer { walk, connection, sheet: ThinSheet::default() };
        loop {
            if !tracer.walk.step() {
                return None;
            }
            let hit = scene.closest_hit(&ray);
            // Surfaces block most connections and cost less than media.
            let surface = hit.map(|hit| scene.interaction(&ray, &hit));
            if let Some(surface) = &surface {
                tracer.pass_surface(scene, surface)?;
            }
            let t_max = surface.as_ref().map_or(ray.t_max, |surface| surface.t);
            tracer.pass_medium(scene, medium, &Ray { t_max, ..ray })?;
            let Some(surface) = surface else { return Some(tracer.connection) };
            medium = medium_beyond(scene, &surface, light.direction, medium);
            ray = light.shadow_ray_from(Vertex::Surface(&surface).origin(light.direction));
        }
    }
}

/// Below this transmittance, Russian roulette ends most connections.
const FAINT: f32 = 0.05;
/// The survival probability of faint connections.
const SURVIVAL: f32 = 0.25;

impl Tracer<'_, '_> {
    fn pass_surface(&mut self, scene: &Scene, surface: &SurfaceInteraction) -> Option<()> {
        if self.sheet.holds(surface) {
            return Some(());
        }
        self.sheet.enter(surface.shape, surface.point);
        let (share, pdf) = scene.prepare_bsdf(surface).null_transmission(surface.wi);
        self.connection.transmittance *= share;
        self.connection.unidirectional_pdf *= pdf;
        (!self.connection.transmittance.is_black()).then_some(())
    }

    fn pass_medium(&mut self, scene: &Scene, medium: Option<MediumId>, ray: &Ray) -> Option<()> {
        let Some(id) = medium else { return Some(()) };
        let medium = scene.medium(id);
        match &medium.density {
            Density::Homogeneous(density) => {
                let interaction = MediumInteraction { point: ray.origin, wi: -ray.direction };
                let area = medium.phase.projected_area(&interaction);
                let transmittance = transmittance(density.extinction() * area, ray.t_max);
                self.connection.transmittance *= transmittance;
                self.connection.unidirectional_pdf *= transmittance;
                (!self.connection.transmittance.is_black()).then_some(())
            }
            Density::Heterogeneous(density) => self.ratio_track(medium, density, ray),
        }
    }

    /// Ratio tracking: every collision multiplies the transmittance by its null fraction (Novák,
    /// Selle and Jarosz, "Residual ratio tracking for estimating attenuation in participating
    /// media", *ACM Transactions on Graphics* 33(6), 2014).
    fn ratio_track(&mut self, medium: &Medium, density: &Heterogeneous, ray: &Ray) -> Option<()> {
        let wi = -ray.direction;
        let mut tracker = density.track(ray);
        loop {
            let collision = match self.walk.collide(&mut tracker) {
                Tentative::Collision(collision) => collision,
                Tentative::None => return Some(()),
                Tentative::TooMany => return None,
            };
            let interaction = MediumInteraction { point: ray.at(collision.t), wi };
            let extinction = medium.coefficients(&interaction).extinction;
            let null = Spectrum::ONE - (extinction / collision.majorant).min(Spectrum::ONE);
            self.connection.transmittance *= null;
            self.connection.unidirectional_pdf *= null;
            let greatest = self.connection.transmittance.max_component();
            if greatest <= 0.0 {
                return None;
            }
            if greatest < FAINT {
                if self.walk.sampler().next_1d() >= SURVIVAL {
                    return None;
                }
                self.connection.transmittance *= 1.0 / SURVIVAL;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::Start;
    use crate::watch::Watch;
    use etendue_document::{Diagnostics, MemoryResources};
    use etendue_mitsuba::{LoadOptions, read_text};
    use etendue_sampling::{SamplerKind, SamplerSpec};
    use etendue_scene::emitter::Target;
    use etendue_scene::{BuildOptions, build_scene};
    use etendue_testkit::Accumulator;
    use glam::UVec2;

    /// A cubic medium whose extinction varies by cell and colour channel.
    fn cube() -> Scene {
        let header = [1, 3, 2, 2, 3].map(i32::to_le_bytes).concat();
        let bounds = [0.0_f32; 6].map(f32::to_le_bytes).concat();
        let values: Vec<u8> =
            (0..36_u8).flat_map(|i| (f32::from(i * 7 % 11) * 0.3).to_le_bytes()).collect();
        let grid = [b"VOL\x03".to_vec(), header, bounds, values].concat();
        let text = r#"<scene version="3.0.0"><shape type="cube"><bsdf type="null"/>
            <medium name="interior" type="heterogeneous"><volume name="sigma_t" type="gridvolume">
            <string name="filename" value="grid.vol"/><transform name="to_world"><translate value="-0.5"/>
            <scale value="2"/></transform></volume></medium></shape><sensor type="perspective"/></scene>"#;
        let diagnostics = Diagnostics::new();
        let resources = MemoryResources::default().with("grid.vol", grid);
        read_text(text, &resources, &LoadOptions::default(), &diagnostics)
            .ok()
            .and_then(|document| {
                build_scene(&document, &resources, &diagnostics, &BuildOptions::default())
            })
            .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()))
    }

    /// The mean of ratio tracking is exp(−∫ σt).
    #[test]
    fn ratio_tracking_is_the_exponential_in_the_mean() {
        let scene = cube();
        let (start, direction) = (Vec3::new(-0.9, -0.7, -0.8), Vec3::new(0.6, 0.5, 0.7));
        let direction = direction.normalize();
        let ray = Ray::new(start, direction);
        let exit = scene.intersect(&ray).expect("the cube's face");
        let medium =
            scene.medium_interface(&exit).and_then(|medium_interface| medium_interface.interior);
        let steps = 20_000;
        let length = f64::from(exit.t) / f64::from(steps);
        let mut depth = [0.0_f64; 3];
        for step in 0..steps {
            let point = ray.at(((f64::from(step) + 0.5) * length) as f32);
            let interaction = MediumInteraction { point, wi: -direction };
            let found = scene.medium(medium.expect("a medium")).coefficients(&interaction);
            let rgb = found.extinction.rgb();
            depth.iter_mut().zip(rgb).for_each(|(sum, sigma)| *sum += f64::from(sigma) * length);
        }
        let radiance = Spectrum::ONE;
        let light =
            DirectionSample { direction, radiance, pdf: 1.0, delta: true, target: Target::Afar };
        let count = 100_000;
        let spec = SamplerSpec::new(SamplerKind::Independent, count, 5);
        let mut found = [(); 3].map(|()| Accumulator::default());
        for index in 0..count {
            let sampler = spec.start(UVec2::ZERO, index);
            let watch = Watch::patient();
            let mut walk = MediumWalk::new(&Start { ray, medium }, &sampler, &watch);
            let passed = Connection::new(&scene, Vertex::Medium(start), &light, &mut walk)
                .map_or(Spectrum::ZERO, |connection| connection.transmittance);
            found.iter_mut().zip(passed.rgb()).for_each(|(sum, value)| sum.add(value.into()));
        }
        for (found, depth) in found.iter().zip(depth) {
            let (mean, expected) = (found.mean(), (-depth).exp());
            assert!(depth > 0.5 && found.standard_error() < 0.02 * expected, "{depth}");
            let distance = (mean - expected).abs();
            assert!(distance < 5.0 * found.standard_error(), "{mean} instead of {expected}");
        }
    }
}
