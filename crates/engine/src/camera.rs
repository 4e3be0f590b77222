//! The source of samples that a scene is: film, sensor, random numbers, integrator.

use etendue_integrators::{CameraRay, Integrator, Radiance, SplatTarget, Start};
use etendue_math::with_lanes;
use etendue_sampling::{Sampler, SamplerSpec, draw_points};
use etendue_scene::{Scene, SensorSetup};
use etendue_spectrum::Spectrum;
use glam::{UVec2, Vec2};

use crate::Splat;
use crate::source::{Sample, SampleId, SampleSource};

/// Where the random numbers of a sample's particle begin, beyond those of its camera ray.
const PARTICLE_DIMENSION: u32 = 4;
/// Where those begin that spread a particle's splats over pixels, far beyond those of its path.
const FILTER_DIMENSION: u32 = 1 << 24;

/// One camera of a scene, ready to be asked for samples.
///
/// A sample takes its random numbers in this order: two for the place within the reconstruction
/// filter, two for the aperture, and the rest is the integrator's.
#[derive(Clone, Copy)]
pub struct Camera<'a> {
    scene: &'a Scene,
    setup: &'a SensorSetup,
    sampler: SamplerSpec,
    integrator: &'a dyn Integrator,
    /// One over the film's width and height.
    pixel_size: Vec2,
}

/// A sample taken alone, to look into it.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// Where it belongs.
    pub id: SampleId,
    /// What it says about its pixel.
    pub sample: Sample,
    /// The values of the extra layers.
    pub layers: Vec<f32>,
}

impl<'a> Camera<'a> {
    /// A camera whose random numbers are planned by `sampler`, which may differ from the scene's.
    pub fn new(
        scene: &'a Scene,
        setup: &'a SensorSetup,
        sampler: SamplerSpec,
        integrator: &'a dyn Integrator,
    ) -> Self {
        let size = UVec2::new(setup.film.width, setup.film.height);
        Self { scene, setup, sampler, integrator, pixel_size: size.as_vec2().recip() }
    }

    /// Where its random numbers come from.
    pub fn sampler(&self) -> &SamplerSpec {
        &self.sampler
    }

    /// Takes one sample exactly as a render takes it.
    pub fn replay(&self, id: SampleId) -> Replay {
        let mut layers = vec![0.0; self.integrator.layers().len()];
        let sample = self.sample(id, &mut layers);
        Replay { id, sample, layers }
    }
}

impl SampleSource for Camera<'_> {
    fn layers(&self) -> &[String] {
        self.integrator.layers()
    }

    fn sample(&self, id: SampleId, layers: &mut [f32]) -> Sample {
        layers.fill(0.0);
        let (mut rays, responses) = self.start(&[id]);
        let CameraRay { start, stream } = &mut rays[0];
        let radiance = self.integrator.sample(self.scene, start, stream, layers);
        responses[0].to(&radiance)
    }

    fn sample_batch(&self, ids: &[SampleId], layers: &mut [f32], samples: &mut Vec<Sample>) {
        layers.fill(0.0);
        let (mut rays, responses) = self.start(ids);
        let mut radiance = Vec::with_capacity(ids.len());
        self.integrator.sample_batch(self.scene, &mut rays, layers, &mut radiance);
        samples.extend(responses.iter().zip(&radiance).map(|(response, light)| response.to(light)));
    }

    fn has_splats(&self) -> bool {
        self.integrator.traces_particles()
    }

    fn splat(&self, id: SampleId, add: &mut dyn FnMut(Splat)) {
        let size = UVec2::new(self.setup.film.width, self.setup.film.height);
        let pixel_count = f64::from(size.x) * f64::from(size.y);
        let pixel = UVec2::new(id.x, id.y);
        let mut stream = self.sampler.start(pixel, id.index);
        stream.set_dimension(PARTICLE_DIMENSION);
        let mut filter_stream = stream;
        filter_stream.set_dimension(FILTER_DIMENSION);
        let mut add_splat = |film_position: Vec2, color: Spectrum| {
            // The filter is sampled, as it is for the camera's own samples.
            let (offset, weight) = self.setup.film.filter.sample(filter_stream.next_2d());
            let place = film_position * size.as_vec2() + offset;
            if place.cmpge(Vec2::ZERO).all() {
                let UVec2 { x, y } = place.as_uvec2();
                let scale = f64::from(weight) * pixel_count;
                add(Splat { x, y, color: color.rgb().map(|value| scale * f64::from(value)) });
            }
        };
        let margin = self.setup.film.filter.radius() * self.pixel_size;
        let target = SplatTarget { sensor: &self.setup.sensor, margin };
        self.integrator.trace_particle(self.scene, target, &mut stream, &mut add_splat);
    }
}

impl Camera<'_> {
    /// The random numbers of samples, of which neighbours mostly belong to one pixel.
    fn streams(&self, ids: &[SampleId]) -> Vec<Sampler> {
        let of_one_pixel = ids.chunk_by(|a, b| (a.x, a.y) == (b.x, b.y));
        let mut streams = Vec::with_capacity(ids.len());
        for ids in of_one_pixel {
            let pixel = self.sampler.pixel(UVec2::new(ids[0].x, ids[0].y));
            streams.extend(ids.iter().map(|id| pixel.start(id.index)));
        }
        streams
    }

    /// The rays that samples start with, and how the camera responds to what arrives along them.
    fn start(&self, ids: &[SampleId]) -> (Vec<CameraRay>, Vec<Response>) {
        let level = self.scene.level();
        let mut streams = self.streams(ids);
        let mut points = Vec::with_capacity(ids.len());
        with_lanes!(level, simd => draw_points(simd, &mut streams, &mut points));
        let filter = &self.setup.film.filter;
        let mut filter_weights = Vec::with_capacity(ids.len());
        for (id, point) in ids.iter().zip(&mut points) {
            let (offset, weight) = filter.sample(*point);
            *point = (UVec2::new(id.x, id.y).as_vec2() + 0.5 + offset) * self.pixel_size;
            filter_weights.push(weight);
        }
        let film_positions = points;
        let apertures = self.draw_apertures(&mut streams);
        let mut sensor_rays = Vec::with_capacity(ids.len());
        let places = (film_positions.as_slice(), apertures.as_slice());
        self.setup.sensor.sample_rays(level, places, &mut sensor_rays);
        let medium = self.setup.medium;
        let rays = sensor_rays
            .iter()
            .zip(streams)
            .map(|(sensor, stream)| CameraRay { start: Start { ray: sensor.ray, medium }, stream })
            .collect();
        let responses = sensor_rays
            .iter()
            .zip(filter_weights)
            .map(|(sensor, filter)| Response { sensor: sensor.weight, filter })
            .collect();
        (rays, responses)
    }

    /// The points of the aperture. The numbers for the lens are passed over where there is none:
    /// drawing them costs, and what follows must not depend on it.
    fn draw_apertures(&self, streams: &mut [Sampler]) -> Vec<Vec2> {
        let mut apertures = Vec::with_capacity(streams.len());
        if self.setup.sensor.has_lens() {
            with_lanes!(self.scene.level(), simd => draw_points(simd, streams, &mut apertures));
            return apertures;
        }
        for stream in streams.iter_mut() {
            stream.set_dimension(stream.dimension().wrapping_add(2));
        }
        apertures.resize(streams.len(), Vec2::ZERO);
        apertures
    }
}

/// What becomes of the radiance that arrives along a camera ray.
#[derive(Clone, Copy)]
struct Response {
    /// The sensor's response.
    sensor: f32,
    /// The reconstruction filter's weight.
    filter: f32,
}

impl Response {
    #[inline]
    fn to(&self, radiance: &Radiance) -> Sample {
        let color = radiance.color * self.sensor;
        Sample { color, alpha: radiance.alpha, weight: self.filter }
    }
}
