//! An integrator that learns between passes: the same bits for any threads, split and resume.

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use etendue_document::{Diagnostics, MemoryResources};
use etendue_engine::{
    Budget, Camera, Cancel, Channels, EngineError, FilmFile, FilmRecord, FilmSums, Host, Job,
    Region, Silent, Workers, render_into,
};
use etendue_image::{Channel, Picture};
use etendue_integrators::{CameraRay, Integrator, Radiance, Start, Training, Watch};
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_sampling::warp::cosine_hemisphere;
use etendue_sampling::{Distribution2D, Sampler};
use etendue_scene::{BuildOptions, Scene, build_scene};
use etendue_spectrum::Spectrum;
use etendue_testkit::{Accumulator, welch};

/// A floor that a small bright square lights, from so far that its direction hardly varies.
const SCENE: &str = r#"
    <scene version="3.0.0">
        <sensor type="orthographic">
            <transform name="to_world">
                <lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/>
            </transform>
            <film type="hdrfilm">
                <integer name="width" value="20"/>
                <integer name="height" value="12"/>
                <rfilter type="box"/>
            </film>
            <sampler type="independent"><integer name="sample_count" value="64"/></sampler>
        </sensor>
        <shape type="rectangle"/>
        <shape type="rectangle">
            <transform name="to_world">
                <scale value="1.6"/><rotate x="1" angle="180"/><translate x="10" z="4"/>
            </transform>
            <emitter type="area"><rgb name="radiance" value="40, 30, 20"/></emitter>
        </shape>
    </scene>"#;

fn build() -> Scene {
    let diagnostics = Diagnostics::new();
    let files = MemoryResources::default();
    let document = read_text(SCENE, &files, &LoadOptions::default(), &diagnostics).ok();
    let scene = document.and_then(|document| {
        build_scene(&document, &files, &diagnostics, &BuildOptions::default())
    });
    scene.unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()))
}

const CELLS: u32 = 8;
const CELL_COUNT: usize = (CELLS * CELLS) as usize;

/// What a white surface without emitter sampling reflects of one emitter. Where it looks for it on
/// the square that [`cosine_hemisphere`] maps to directions, it has learned.
struct Learner {
    /// How likely each cell of the square is, once something has been learned.
    guide: Option<Distribution2D>,
    /// Samples per pixel of each training pass.
    passes: Vec<u32>,
}

impl Learner {
    fn untrained() -> Self {
        Self { guide: None, passes: vec![2, 4] }
    }

    /// The light of one sample, and the cell that it came from.
    fn estimate(&self, scene: &Scene, start: &Start, sampler: &mut Sampler) -> (Spectrum, usize) {
        let uniform = sampler.next_2d();
        let (point, pdf) =
            self.guide.as_ref().map_or((uniform, 1.0), |guide| guide.sample(uniform));
        let cell = (point * CELLS as f32).as_uvec2();
        let cell = (cell.y * CELLS + cell.x) as usize;
        let Some(floor) = scene.intersect(&start.ray) else { return (Spectrum::ZERO, cell) };
        let direction = floor.to_world(cosine_hemisphere::sample(point));
        let found = scene.intersect(&floor.spawn_ray(direction)).and_then(|surface| {
            let emitter = scene.emitter_of(&surface)?;
            Some(scene.emitter(emitter).surface_radiance(scene, &surface))
        });
        (found.unwrap_or(Spectrum::ZERO) / pdf, cell)
    }
}

impl Integrator for Learner {
    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        sampler: &mut Sampler,
        _: &mut [f32],
        _: &Watch<'_>,
    ) -> Radiance {
        Radiance { color: self.estimate(scene, start, sampler).0, alpha: 1.0 }
    }

    fn training(&self) -> Option<Box<dyn Training>> {
        let learner = Self { guide: None, passes: self.passes.clone() };
        let sums = std::array::from_fn(|_| AtomicU64::new(0));
        (!self.passes.is_empty()).then(|| Box::new(Lesson { learner, sums }) as Box<dyn Training>)
    }
}

/// The training of a [`Learner`].
struct Lesson {
    learner: Learner,
    /// The light of each cell in units of 2⁻¹⁶: integers, whose order does not matter.
    sums: [AtomicU64; CELL_COUNT],
}

impl Training for Lesson {
    fn samples_of_passes(&self) -> &[u32] {
        &self.learner.passes
    }

    fn learn(&self, scene: &Scene, rays: &mut [CameraRay]) {
        for CameraRay { start, sampler } in rays {
            let (light, cell) = self.learner.estimate(scene, start, sampler);
            let units = light.max_component() * 65_536.0;
            self.sums[cell].fetch_add(units as u64, Ordering::Relaxed);
        }
    }

    fn refine(&mut self) {
        let sums = self.sums.each_mut().map(|sum| std::mem::take(sum.get_mut()) as f32);
        let floor = 0.2 * sums.iter().sum::<f32>() / CELL_COUNT as f32;
        let weights = sums.map(|sum| sum + floor);
        self.learner.guide = Some(Distribution2D::new(&weights, (CELLS, CELLS)).unwrap());
    }

    fn finish(self: Box<Self>) -> Box<dyn Integrator> {
        Box::new(Learner { passes: Vec::new(), ..self.learner })
    }
}

const WHOLE: Region = Region { x: 0, y: 0, width: 20, height: 12 };
const COUNT: u32 = 16;

fn workers(threads: usize) -> Workers {
    Workers::new(NonZeroUsize::new(threads)).unwrap()
}

/// The scene's camera, with any integrator.
fn camera_of(scene: &Arc<Scene>, integrator: impl Into<Arc<dyn Integrator>>) -> Camera {
    let setup = scene.sensors()[0].clone();
    let sampler = setup.sampler;
    Camera::new(Arc::clone(scene), setup, sampler, integrator.into())
}

fn untrained() -> Arc<dyn Integrator> {
    Arc::new(Learner::untrained())
}

/// Trains and renders as one run of a program does: samples `first` to below `end` of a region, into
/// the film that an earlier run has left as a file, if there is one.
fn run(
    scene: &Arc<Scene>,
    threads: usize,
    region: Region,
    samples: [u32; 2],
    file: &[u8],
) -> Vec<u8> {
    let (workers, cancel) = (workers(threads), Cancel::new());
    let camera = camera_of(scene, untrained());
    let trained = camera.train(&workers, &cancel).unwrap().unwrap();
    assert!(trained.training().is_none(), "there is nothing left to learn");
    let camera = camera_of(scene, trained);
    let [first_sample, end] = samples;
    let budget = Budget { samples_per_pixel: Some(end), time: None };
    let job = Job { region, first_sample, budget, variance: true, memory_limit: 1 << 30 };
    let film = match file {
        [] => FilmSums::new(&job, &camera, threads).unwrap(),
        bytes => read(bytes),
    };
    let host = Host { workers: &workers, observer: &Silent, cancel: &cancel };
    render_into(&camera, &film, budget, &host).unwrap();
    let mut bytes = Vec::new();
    film.write(&FilmRecord::default(), &mut bytes).unwrap();
    bytes
}

fn read(bytes: &[u8]) -> FilmSums {
    let mut input = bytes;
    let file = FilmFile::read_header(&mut input).unwrap();
    file.read_sums(&mut input, bytes.len() as u64, 1 << 30).unwrap()
}

fn picture(file: &[u8]) -> Picture {
    read(file).develop(Channels { alpha: true, variance: true })
}

#[test]
fn threads_do_not_change_what_is_learned() {
    let scene = Arc::new(build());
    let one = picture(&run(&scene, 1, WHOLE, [0, COUNT], &[]));
    for threads in [2, 5] {
        assert_eq!(
            picture(&run(&scene, threads, WHOLE, [0, COUNT], &[])),
            one,
            "{threads} threads"
        );
    }
}

#[test]
fn a_resumed_run_learns_the_same_again() {
    let scene = Arc::new(build());
    let whole = picture(&run(&scene, 2, WHOLE, [0, COUNT], &[]));
    for pause in [1, 7] {
        let file = run(&scene, 1, WHOLE, [0, pause], &[]);
        assert_eq!(picture(&run(&scene, 5, WHOLE, [0, COUNT], &file)), whole, "paused at {pause}");
    }
}

#[test]
fn parts_learn_the_same_and_merge() {
    let scene = Arc::new(build());
    let whole = picture(&run(&scene, 2, WHOLE, [0, COUNT], &[]));
    let mut merged = read(&run(&scene, 1, WHOLE, [11, COUNT], &[]));
    for samples in [[3, 11], [0, 3]] {
        merged.merge(&read(&run(&scene, 2, WHOLE, samples, &[]))).unwrap();
    }
    assert_eq!(merged.develop(Channels { alpha: true, variance: true }), whole);
}

#[test]
fn a_region_has_the_pixels_of_the_whole_picture() {
    let scene = Arc::new(build());
    let whole = picture(&run(&scene, 2, WHOLE, [0, COUNT], &[]));
    let region = Region { x: 7, y: 4, width: 9, height: 5 };
    let part = picture(&run(&scene, 2, region, [0, COUNT], &[]));
    // Variances are means over neighbours, which the edge of the region cuts off.
    let is_of_a_pixel = |(part, _): &(&Channel, _)| !part.name.starts_with("variance.");
    for (part, whole) in part.channels.iter().zip(&whole.channels).filter(is_of_a_pixel) {
        let rows = whole.data.chunks(WHOLE.width as usize).skip(4).take(5);
        let expected: Vec<f32> = rows.flat_map(|row| row[7..16].to_vec()).collect();
        assert_eq!(part.data, expected, "{}", part.name);
    }
}

#[test]
fn what_is_learned_lowers_the_variance_and_not_the_mean() {
    let scene = Arc::new(build());
    let camera = camera_of(&scene, untrained());
    let trained = camera.train(&workers(2), &Cancel::new()).unwrap().unwrap();
    let light = |integrator: Arc<dyn Integrator>| -> Accumulator {
        let camera = camera_of(&scene, integrator);
        let ids = (0..20_000).map(|index| etendue_engine::SampleId {
            index,
            y: index % 12,
            x: index % 20,
        });
        ids.map(|id| f64::from(camera.replay(id).sample.color.max_component())).collect()
    };
    let (before, after) = (light(untrained()), light(trained.into()));
    assert!(welch(&before, &after).accepts(1e-4), "{} {}", before.mean(), after.mean());
    assert!(after.variance() * 2.0 < before.variance(), "{after:?} {before:?}");
}

#[test]
fn training_can_be_cancelled() {
    let scene = Arc::new(build());
    let camera = camera_of(&scene, untrained());
    let cancel = Cancel::new();
    cancel.cancel();
    let result = camera.train(&workers(1), &cancel);
    assert_eq!(result.map(|_| ()).unwrap_err(), EngineError::Cancelled);
}
