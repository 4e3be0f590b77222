//! The source of samples that a scene is: film, sensor, random numbers, integrator.

use etendue_integrators::{
    CameraRay, ChannelKind, Integrator, Radiance, Splat, SplatTarget, Start, Watch,
};
use etendue_math::with_lanes;
use etendue_sampling::{Sampler, SamplerSpec, draw_points};
use etendue_scene::{Scene, SensorSetup};
use glam::{UVec2, Vec2};
use std::sync::Arc;

use crate::region::Region;
use crate::source::{PixelSplatSink, Sample, SampleId, SampleSource, SplatSource};
use crate::splats::PixelSplat;

/// The dimension where the integrator's random numbers begin, beyond those of the camera ray.
const INTEGRATOR_DIMENSION: u32 = 4;
/// The dimension where the random numbers begin that filter a particle's splats, far beyond those
/// of its path.
const FILTER_DIMENSION: u32 = 1 << 24;

/// One camera of a scene, ready to be asked for samples.
///
/// The first two random numbers of a sample choose the place within the reconstruction filter, the
/// next two the point of the aperture; the rest are the integrator's.
#[derive(Clone)]
pub struct Camera {
    scene: Arc<Scene>,
    setup: SensorSetup,
    sampler: SamplerSpec,
    integrator: Arc<dyn Integrator>,
    /// One over the film's width and height.
    pixel_size: Vec2,
}

/// A sample taken alone, to look into it.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// Its name.
    pub id: SampleId,
    /// What it adds to its pixel.
    pub sample: Sample,
    /// The values of the integrator's channels.
    pub channels: Vec<f32>,
}

impl Camera {
    /// A camera whose random numbers are planned by `sampler`, which may differ from the scene's.
    pub fn new(
        scene: Arc<Scene>,
        setup: SensorSetup,
        sampler: SamplerSpec,
        integrator: Arc<dyn Integrator>,
    ) -> Self {
        let size = UVec2::new(setup.film.width, setup.film.height);
        Self { scene, setup, sampler, integrator, pixel_size: size.as_vec2().recip() }
    }

    /// The sensor with its film, as the scene says.
    pub fn setup(&self) -> &SensorSetup {
        &self.setup
    }

    /// Where its random numbers come from.
    pub fn sampler(&self) -> &SamplerSpec {
        &self.sampler
    }

    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// How light is computed.
    pub fn integrator(&self) -> &dyn Integrator {
        &*self.integrator
    }

    /// The whole film, whatever part of it is rendered.
    pub(crate) fn film_region(&self) -> Region {
        let film = &self.setup.film;
        Region { x: 0, y: 0, width: film.width, height: film.height }
    }

    /// The same camera with other random numbers.
    pub(crate) fn with_sampler(&self, sampler: SamplerSpec) -> Self {
        Self { sampler, ..self.clone() }
    }

    /// Takes one sample exactly as a render takes it.
    pub fn replay(&self, id: SampleId) -> Replay {
        let mut channels = vec![0.0; self.integrator.channels().len()];
        let (mut rays, responses) = self.start(&[id]);
        let CameraRay { start, sampler } = &mut rays[0];
        let watch = Watch::patient();
        let radiance = self.integrator.sample(&self.scene, start, sampler, &mut channels, &watch);
        Replay { id, sample: responses[0].to(&radiance), channels }
    }
}

impl SampleSource for Camera {
    fn channels(&self) -> &[String] {
        self.integrator.channels()
    }

    fn channel_kinds(&self) -> Vec<ChannelKind> {
        self.integrator.channel_kinds()
    }

    fn is_out_of_gamut(&self) -> bool {
        self.scene.is_out_of_gamut()
    }

    fn take_samples(
        &self,
        ids: &[SampleId],
        channels: &mut [f32],
        watch: &Watch<'_>,
        samples: &mut Vec<Sample>,
    ) {
        channels.fill(0.0);
        let (mut rays, responses) = self.start(ids);
        let mut radiance = Vec::with_capacity(ids.len());
        self.integrator.sample_batch(&self.scene, &mut rays, channels, watch, &mut radiance);
        samples.extend(responses.iter().zip(&radiance).map(|(response, light)| response.to(light)));
    }

    fn splats(&self) -> Option<&dyn SplatSource> {
        self.integrator.particles().is_some().then_some(self)
    }
}

impl SplatSource for Camera {
    fn trace_splats(&self, id: SampleId, watch: &Watch<'_>, sink: &mut PixelSplatSink<'_>) {
        let Some(particles) = self.integrator.particles() else { return };
        let film = &self.setup.film;
        let size = UVec2::new(film.width, film.height);
        let pixel_count = f64::from(size.x) * f64::from(size.y);
        let mut sampler = self.sampler.start(UVec2::new(id.x, id.y), id.index);
        sampler.set_dimension(INTEGRATOR_DIMENSION);
        let mut filter_sampler = sampler;
        filter_sampler.set_dimension(FILTER_DIMENSION);
        let mut filtered_sink = |Splat { film_position, color }| {
            // The filter is sampled, as it is for the camera's own samples.
            let (offset, weight) = film.filter.sample(filter_sampler.next_2d());
            let place = film_position * size.as_vec2() + offset;
            if place.cmpge(Vec2::ZERO).all() {
                let UVec2 { x, y } = place.as_uvec2();
                let scale = f64::from(weight) * pixel_count;
                sink(PixelSplat { x, y, color: color.rgb().map(|value| scale * f64::from(value)) });
            }
        };
        let margin = film.filter.radius() * self.pixel_size;
        let target = SplatTarget { sensor: &self.setup.sensor, margin };
        particles.trace_particle(&self.scene, &mut sampler, &target, &mut filtered_sink, watch);
    }
}

impl Camera {
    /// The samplers of some ids, of which neighbours mostly belong to one pixel.
    fn samplers(&self, ids: &[SampleId]) -> Vec<Sampler> {
        let of_one_pixel = ids.chunk_by(|a, b| (a.x, a.y) == (b.x, b.y));
        let mut samplers = Vec::with_capacity(ids.len());
        for ids in of_one_pixel {
            let pixel = self.sampler.pixel(UVec2::new(ids[0].x, ids[0].y));
            samplers.extend(ids.iter().map(|id| pixel.start(id.index)));
        }
        samplers
    }

    /// The rays that samples start with, and how the camera responds to what arrives along them.
    pub(crate) fn start(&self, ids: &[SampleId]) -> (Vec<CameraRay>, Vec<Response>) {
        let level = self.scene.level();
        let mut samplers = self.samplers(ids);
        let mut points = Vec::with_capacity(ids.len());
        with_lanes!(level, simd => draw_points(simd, &mut samplers, &mut points));
        let filter = &self.setup.film.filter;
        let mut filtered = Vec::with_capacity(ids.len());
        for (id, point) in ids.iter().zip(&mut points) {
            let (offset, weight) = filter.sample(*point);
            *point = (UVec2::new(id.x, id.y).as_vec2() + 0.5 + offset) * self.pixel_size;
            filtered.push((weight, offset.length_squared()));
        }
        let film_positions = points;
        let apertures = self.draw_apertures(&mut samplers);
        let mut sensor_rays = Vec::with_capacity(ids.len());
        let places = (film_positions.as_slice(), apertures.as_slice());
        self.setup.sensor.sample_rays(level, places, &mut sensor_rays);
        let medium = self.setup.medium;
        let rays = sensor_rays
            .iter()
            .zip(samplers)
            .map(|(sensor, sampler)| CameraRay {
                start: Start { ray: sensor.ray, medium },
                sampler,
            })
            .collect();
        let responses = sensor_rays
            .iter()
            .zip(filtered)
            .map(|(sensor, (filter, squared_distance))| Response {
                sensor: sensor.weight,
                filter,
                squared_distance,
            })
            .collect();
        (rays, responses)
    }

    /// The points of the aperture. Without a lens, their numbers are skipped: drawing them costs
    /// time, and the numbers that follow must not depend on it.
    fn draw_apertures(&self, samplers: &mut [Sampler]) -> Vec<Vec2> {
        let mut apertures = Vec::with_capacity(samplers.len());
        if self.setup.sensor.has_lens() {
            with_lanes!(self.scene.level(), simd => draw_points(simd, samplers, &mut apertures));
            return apertures;
        }
        for sampler in samplers.iter_mut() {
            sampler.set_dimension(sampler.dimension().wrapping_add(2));
        }
        apertures.resize(samplers.len(), Vec2::ZERO);
        apertures
    }
}

/// How the camera weighs the radiance that arrives along a ray.
#[derive(Clone, Copy)]
pub(crate) struct Response {
    /// The sensor's response.
    sensor: f32,
    /// The reconstruction filter's weight.
    filter: f32,
    /// From the pixel's centre, in pixels.
    squared_distance: f32,
}

impl Response {
    #[inline]
    fn to(&self, radiance: &Radiance) -> Sample {
        let color = radiance.color * self.sensor;
        Sample {
            color,
            alpha: radiance.alpha,
            weight: self.filter,
            squared_distance: self.squared_distance,
        }
    }
}
