//! Light that is traced from its source makes the picture that light traced from the camera makes.

use std::sync::{Arc, Mutex};

use etendue_document::{Diagnostics, MemoryResources};
use etendue_engine::{
    Budget, Camera, Cancel, Channels, Host, Job, Region, Silent, Workers, render,
};
use etendue_integrators::{
    Integrator, IntegratorOptions, ParticleIntegrator, Radiance, Splat, SplatSink, SplatTarget,
    Start, Watch, build_integrator,
};
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_sampling::{Sampler, SamplerSpec};
use etendue_scene::{BuildOptions, Scene, build_scene};
use etendue_testkit::{Accumulator, welch};

const SIZE: u32 = 16;

fn build(text: &str, integrator: &str) -> (Arc<Scene>, Arc<dyn Integrator>) {
    let diagnostics = Diagnostics::new();
    let files = MemoryResources::default();
    let text = format!(
        "<scene version=\"3.0.0\"><integrator type=\"{integrator}\">
        <integer name=\"max_depth\" value=\"4\"/></integrator>{text}</scene>"
    );
    let built =
        read_text(&text, &files, &LoadOptions::default(), &diagnostics).ok().and_then(|document| {
            let scene = build_scene(&document, &files, &diagnostics, &BuildOptions::default())?;
            let options = IntegratorOptions::default();
            let integrator = build_integrator(&document, &options, &diagnostics)?;
            Some((Arc::new(scene), Arc::from(integrator)))
        });
    built.unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()))
}

fn sensor(kind: &str, inner: &str) -> String {
    format!(
        "<sensor type=\"{kind}\">{inner}
        <transform name=\"to_world\"><scale value=\"1.3\"/>
            <lookat origin=\"0.3, 4, 1.5\" target=\"0, 0, 0.3\" up=\"0, 0, 1\"/></transform>
        <film type=\"hdrfilm\"><integer name=\"width\" value=\"{SIZE}\"/>
            <integer name=\"height\" value=\"{SIZE}\"/><rfilter type=\"tent\"/></film>
        <sampler type=\"independent\"/></sensor>"
    )
}

/// Rough things on a floor, and a mesh with shading normals of its own.
const OBJECTS: &str = r#"
    <shape type="rectangle"><transform name="to_world"><scale value="2"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.5, 0.3"/></bsdf></shape>
    <shape type="sphere"><point name="center" x="-0.6" y="0" z="0.5"/>
        <float name="radius" value="0.5"/><bsdf type="roughplastic"><float name="alpha" value="0.3"/></bsdf></shape>
    <shape type="cube"><transform name="to_world"><scale value="0.3"/>
        <translate x="0.7" y="0.4" z="0.4"/></transform>
        <bsdf type="roughdielectric"><float name="alpha" value="0.4"/></bsdf></shape>"#;

/// The means of the quarters of pictures of several seeds, as `quarter × channel`.
fn quarters(scene: &Arc<Scene>, integrator: &Arc<dyn Integrator>, seeds: u64) -> Vec<Accumulator> {
    let setup = &scene.sensors()[0];
    let workers = Workers::new(None).unwrap();
    let mut means = vec![Accumulator::default(); 12];
    for seed in 0..seeds {
        let sampler = SamplerSpec::new(setup.sampler.kind(), 64, seed);
        let camera = Camera::new(scene.clone(), setup.clone(), sampler, integrator.clone());
        let budget = Budget { samples_per_pixel: Some(64), time: None };
        let region = Region { x: 0, y: 0, width: SIZE, height: SIZE };
        let job = Job { region, first_sample: 0, budget, variance: false, memory_limit: 1 << 30 };
        let host = Host { workers: &workers, observer: &Silent, cancel: &Cancel::new() };
        let (film, _) = render(&camera, &job, &host).unwrap();
        let picture = film.develop(Channels::default());
        for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
            let data = &picture.channel(name).unwrap().data;
            let half = SIZE as usize / 2;
            for quarter in 0..4 {
                let (left, top) = (quarter % 2 * half, quarter / 2 * half);
                let rows = data.chunks(SIZE as usize).skip(top).take(half);
                let sum: f32 = rows.flat_map(|row| &row[left..left + half]).sum();
                means[3 * quarter + channel].add(f64::from(sum) / (half * half) as f64);
            }
        }
    }
    means
}

#[test]
fn particles_and_paths_make_the_same_picture() {
    let sensors = [
        sensor(
            "perspective",
            "<float name=\"fov\" value=\"40\"/>
             <float name=\"principal_point_offset_x\" value=\"0.1\"/>",
        ),
        sensor(
            "thinlens",
            "<float name=\"fov\" value=\"40\"/><float name=\"aperture_radius\" value=\"0.2\"/>
             <float name=\"focus_distance\" value=\"2\"/>",
        ),
        sensor("orthographic", ""),
    ];
    let lights = [
        r#"<emitter type="point"><point name="position" x="0" y="1" z="2.5"/>
            <rgb name="intensity" value="5"/></emitter>"#,
        r#"<shape type="rectangle"><transform name="to_world"><scale value="0.4"/>
            <rotate x="1" angle="200"/><translate y="0.5" z="2"/></transform>
            <emitter type="area"><rgb name="radiance" value="6, 4, 2"/></emitter></shape>
           <emitter type="directional"><vector name="direction" x="0.2" y="-0.3" z="-1"/></emitter>"#,
        r#"<emitter type="constant"/>"#,
    ];
    for sensor in &sensors {
        for light in lights {
            let text = format!("{sensor}{OBJECTS}{light}");
            let (scene, path) = build(&text, "path");
            let (_, particles) = build(&text, "ptracer");
            let (paths, particles) =
                (quarters(&scene, &path, 12), quarters(&scene, &particles, 12));
            for (index, (path, particle)) in paths.iter().zip(&particles).enumerate() {
                // 108 comparisons in all.
                let outcome = welch(path, particle);
                assert!(
                    outcome.accepts(1e-5),
                    "{sensor} {light} {index}: {} {} {outcome:?}",
                    path.mean(),
                    particle.mean()
                );
            }
        }
    }
}

#[test]
fn threads_and_divided_runs_leave_the_same_splats() {
    let light = r#"<emitter type="constant"/>"#;
    let text = format!("{}{OBJECTS}{light}", sensor("perspective", ""));
    let (scene, integrator) = build(&text, "ptracer");
    let setup = &scene.sensors()[0];
    let camera = Camera::new(scene.clone(), setup.clone(), setup.sampler, integrator);
    let picture = |threads: usize| {
        let budget = Budget { samples_per_pixel: Some(16), time: None };
        let region = Region { x: 3, y: 0, width: SIZE - 3, height: SIZE };
        let job = Job { region, first_sample: 0, budget, variance: false, memory_limit: 1 << 30 };
        let workers = Workers::new(std::num::NonZeroUsize::new(threads)).unwrap();
        let host = Host { workers: &workers, observer: &Silent, cancel: &Cancel::new() };
        let (film, _) = render(&camera, &job, &host).unwrap();
        film.develop(Channels::default())
    };
    let one = picture(1);
    assert!(one.channel("R").unwrap().data.iter().any(|value| *value > 0.0));
    for threads in [2, 5] {
        assert_eq!(picture(threads), one, "{threads} threads");
    }
}

/// Finds a share of the light by camera paths and the rest by particles, as a bidirectional
/// integrator does.
struct Joined {
    paths: Arc<dyn Integrator>,
    particles: Arc<dyn Integrator>,
}

const PATH_SHARE: f32 = 0.25;

impl Integrator for Joined {
    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        sampler: &mut Sampler,
        channels: &mut [f32],
        watch: &Watch<'_>,
    ) -> Radiance {
        let path = self.paths.sample(scene, start, &mut { *sampler }, channels, watch);
        let seen = self.particles.sample(scene, start, sampler, channels, watch);
        let color = path.color * PATH_SHARE + seen.color * (1.0 - PATH_SHARE);
        Radiance { color, ..path }
    }

    fn particles(&self) -> Option<&dyn ParticleIntegrator> {
        Some(self)
    }
}

impl ParticleIntegrator for Joined {
    fn trace_particle(
        &self,
        scene: &Scene,
        sampler: &mut Sampler,
        target: &SplatTarget<'_>,
        sink: &mut SplatSink<'_>,
        watch: &Watch<'_>,
    ) {
        let mut weighted_sink =
            |splat: Splat| sink(Splat { color: splat.color * (1.0 - PATH_SHARE), ..splat });
        let particles = self.particles.particles().unwrap();
        particles.trace_particle(scene, sampler, target, &mut weighted_sink, watch);
    }
}

#[test]
fn camera_paths_and_particles_add_up() {
    let light = r#"<emitter type="constant"/>"#;
    let text = format!("{}{OBJECTS}{light}", sensor("perspective", ""));
    let (scene, path) = build(&text, "path");
    let expected = quarters(&scene, &path, 12);
    let joined = Joined { paths: path, particles: build(&text, "ptracer").1 };
    let joined: Arc<dyn Integrator> = Arc::new(joined);
    for (index, (path, joined)) in expected.iter().zip(&quarters(&scene, &joined, 12)).enumerate() {
        let outcome = welch(path, joined);
        assert!(outcome.accepts(1e-4), "{index}: {} {}", path.mean(), joined.mean());
    }
}

/// Keeps the random numbers that it is given.
#[derive(Default)]
struct Recorder {
    camera_samples: Mutex<Vec<Sampler>>,
    particles: Mutex<Vec<Sampler>>,
}

impl Integrator for Recorder {
    fn sample(
        &self,
        _: &Scene,
        _: &Start,
        sampler: &mut Sampler,
        _: &mut [f32],
        _: &Watch<'_>,
    ) -> Radiance {
        self.camera_samples.lock().unwrap().push(*sampler);
        Radiance::NONE
    }

    fn particles(&self) -> Option<&dyn ParticleIntegrator> {
        Some(self)
    }
}

impl ParticleIntegrator for Recorder {
    fn trace_particle(
        &self,
        _: &Scene,
        sampler: &mut Sampler,
        _: &SplatTarget<'_>,
        _: &mut SplatSink<'_>,
        _: &Watch<'_>,
    ) {
        self.particles.lock().unwrap().push(*sampler);
    }
}

#[test]
fn a_particle_has_the_random_numbers_of_its_camera_sample() {
    let aperture = r#"<float name="aperture_radius" value="0.2"/>"#;
    let (scene, _) = build(&sensor("thinlens", aperture), "path");
    let recorder = Arc::new(Recorder::default());
    let integrator: Arc<dyn Integrator> = recorder.clone();
    quarters(&scene, &integrator, 1);
    drop(integrator);
    let recorder = Arc::into_inner(recorder).expect("nobody else holds it");
    let sorted = |samplers: Mutex<Vec<Sampler>>| {
        let samplers = samplers.into_inner().unwrap();
        let mut texts: Vec<_> = samplers.iter().map(|sampler| format!("{sampler:?}")).collect();
        texts.sort_unstable();
        texts
    };
    let camera_samples = sorted(recorder.camera_samples);
    assert_eq!(camera_samples.len(), 64 * (SIZE * SIZE) as usize);
    assert_eq!(camera_samples, sorted(recorder.particles));
}
