//! Rendering one camera of one scene.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use etendue_document::{MemoryResources, Node, Resources};
use etendue_engine::{
    Budget, Camera, Cancel, FilmRecord, FilmSums, Host, Job, Observer, Region, SampleSource,
    Silent, Statistics, Workers, render_into,
};
use etendue_sampling::SamplerSpec;
use etendue_scene::SensorSetup;

use crate::development::{Development, hexadecimal};
use crate::error::Error;
use crate::files::Files;
use crate::load::{Loaded, load, load_node, load_text};
use crate::loaded_scene::LoadedScene;
use crate::options::{DEFAULT_MEMORY_LIMIT, RenderOptions, SceneOptions, SensorChoice};
use crate::rendering::Rendering;

/// Reads a scene file from disk and renders it: the whole process on one page.
///
/// Relative paths start at the current folder. Warnings are dropped here; [`load`] returns them.
///
/// # Errors
///
/// [`Error`] if the scene cannot be loaded, has no such camera, or cannot be rendered.
pub fn render_file(
    path: impl AsRef<Path>,
    scene_options: &SceneOptions,
    options: &RenderOptions,
) -> Result<Rendering, Error> {
    let path = path.as_ref();
    let files = Files::default();
    let folder = std::env::current_dir().unwrap_or_default();
    render_loaded(options, || load(path, folder, &files, scene_options))
}

/// Renders a scene given as text. The text cannot name files.
///
/// # Errors
///
/// Same as [`render_file`].
pub fn render_text(
    text: &str,
    scene_options: &SceneOptions,
    options: &RenderOptions,
) -> Result<Rendering, Error> {
    let nothing: &dyn Resources = &MemoryResources::default();
    render_loaded(options, || load_text(text, PathBuf::new(), nothing, scene_options))
}

/// Renders a scene built in code. Files that it names are looked up in the current folder.
///
/// # Errors
///
/// Same as [`render_file`].
pub fn render_node(
    scene: Node,
    scene_options: &SceneOptions,
    options: &RenderOptions,
) -> Result<Rendering, Error> {
    let files = Files::default();
    let folder = std::env::current_dir().unwrap_or_default();
    render_loaded(options, || load_node(scene, folder, &files, scene_options))
}

fn render_loaded(
    options: &RenderOptions,
    load: impl FnOnce() -> Loaded + Send,
) -> Result<Rendering, Error> {
    let workers = Workers::new(options.threads)?;
    let loaded = workers.run(load);
    let scene = loaded.scene.ok_or_else(|| Error::Scene(Box::new(loaded.diagnostics)))?;
    RenderJob::new(&scene, options)?.render(&workers, &Silent, &Cancel::new())
}

/// A camera that is ready to render. It shares ownership of its scene.
#[derive(Clone)]
pub struct RenderJob {
    camera: Camera,
    scene: LoadedScene,
    sensor_index: usize,
    job: Job,
    planned_samples: u32,
    development: Development,
}

impl RenderJob {
    /// Selects a camera of the scene and its budget.
    ///
    /// # Errors
    ///
    /// [`Error::Sensor`] if there is no such camera; [`Error::Region`] if the region to render does
    /// not lie within its film; [`Error::Samples`] if the samples are not among those planned.
    pub fn new(scene: &LoadedScene, options: &RenderOptions) -> Result<Self, Error> {
        let (sensor_index, setup) = find_sensor(scene, &options.sensor)?;
        let own_count = setup.sampler.rounded_sample_count();
        // A time limit alone means an unlimited number of samples.
        let default_count = options.time_limit.is_none().then_some(own_count);
        let count = options.samples_per_pixel.or(default_count);
        let planned = options.planned_samples.or(count).unwrap_or(own_count);
        let (first_sample, end) = match &options.samples {
            None => (0, count),
            Some(choice) => {
                let samples = choice.indices(planned);
                if samples.is_empty() || samples.end > planned {
                    return Err(Error::Samples { samples, planned });
                }
                (samples.start, Some(samples.end))
            }
        };
        let seed = options.seed.unwrap_or(setup.sampler.seed());
        let plan = if options.variance { SamplerSpec::in_halves } else { SamplerSpec::new };
        let sampler = plan(setup.sampler.kind(), planned, seed);
        let job = Job {
            region: find_region(setup, options.region)?,
            first_sample,
            budget: Budget { samples_per_pixel: end, time: options.time_limit },
            variance: options.variance,
            memory_limit: options.memory_limit.unwrap_or(DEFAULT_MEMORY_LIMIT),
        };
        let camera = Camera::new(
            Arc::clone(&scene.scene),
            setup.clone(),
            sampler,
            Arc::clone(&scene.integrator),
        );
        let development = Development::new(&camera, &scene.scene.content_hash());
        let development = Development {
            exposure: options.exposure.unwrap_or(development.exposure),
            tone_map: options.tone_map.unwrap_or(development.tone_map),
            scene_name: options.scene_name.clone(),
            ..development
        };
        let (scene, planned_samples) = (scene.clone(), planned);
        Ok(Self { camera, scene, sensor_index, job, planned_samples, development })
    }

    /// The source of its samples, to replay one of them.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The region to render and its budget.
    pub fn job(&self) -> &Job {
        &self.job
    }

    /// The camera with its film and its sampler, as described by the scene.
    pub fn setup(&self) -> &SensorSetup {
        self.camera.setup()
    }

    /// The memory in bytes of the film and the finished picture, without the scene.
    pub fn memory_needed(&self) -> u64 {
        FilmSums::memory_needed(&self.job, &self.camera)
    }

    /// Everything that determines the picture, by name. The sums of two renders can be combined if
    /// these are equal.
    pub fn identity(&self) -> Vec<(String, String)> {
        let sampler = self.camera.sampler();
        let Region { x, y, width, height } = self.job.region;
        let film = &self.setup().film;
        let [columns, rows] = [film.width, film.height];
        let own = [
            ("version of Etendue", env!("CARGO_PKG_VERSION").to_owned()),
            ("scene and its files", hexadecimal(&self.scene.scene.content_hash())),
            ("sensor", self.sensor_index.to_string()),
            ("film", format!("{columns}x{rows}")),
            ("pixels", format!("{width}x{height} from ({x}, {y})")),
            ("sampler", format!("{:?}", sampler.kind())),
            ("planned samples", self.planned_samples.to_string()),
            ("seed", sampler.seed().to_string()),
            ("layers", self.camera.channels().join(", ")),
            ("variance", self.job.variance.to_string()),
        ];
        let own = own.map(|(name, value)| (name.to_owned(), value));
        own.into_iter().chain(self.scene.settings.iter().cloned()).collect()
    }

    /// The metadata stored with this job's sums, which took this long.
    pub fn record(&self, seconds: f64) -> FilmRecord {
        FilmRecord {
            identity: self.identity(),
            notes: self.development.to_notes(),
            planned_samples: self.planned_samples,
            seconds,
        }
    }

    /// A film without samples.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if it would need too much memory.
    pub fn new_film(&self, workers: &Workers) -> Result<FilmSums, Error> {
        Ok(FilmSums::new(&self.job, &self.camera, workers.thread_count())?)
    }

    /// Whether sums, such as those of a file, have the pixels, layers and first sample of this job.
    pub fn owns(&self, film: &FilmSums) -> bool {
        film.belongs_to(&self.job, &self.camera)
    }

    /// Trains the integrator, where it learns before the picture's first sample. Call this before
    /// [`Self::render_into`]; [`Self::render`] does so itself. Every part of a picture and every resumed
    /// run learns the same, bit for bit.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if `cancel` stopped the training.
    pub fn train(&mut self, workers: &Workers, cancel: &Cancel) -> Result<(), Error> {
        if let Some(integrator) = self.camera.train(workers, cancel)? {
            self.camera = Camera::new(
                Arc::clone(&self.scene.scene),
                self.camera.setup().clone(),
                *self.camera.sampler(),
                integrator.into(),
            );
        }
        Ok(())
    }

    /// Adds samples to sums, which may hold some of an earlier run, until the budget is spent or
    /// `cancel` says stop.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if the render cannot start.
    pub fn render_into(
        &self,
        film: &FilmSums,
        workers: &Workers,
        observer: &dyn Observer,
        cancel: &Cancel,
    ) -> Result<Statistics, Error> {
        let host = Host { workers, observer, cancel };
        Ok(render_into(&self.camera, film, self.job.budget, &host)?)
    }

    /// Develops the sums of this job into a picture; `seconds` is the wall time of all runs that
    /// contributed.
    pub fn develop(&self, film: &FilmSums, statistics: Statistics, seconds: f64) -> Rendering {
        Rendering::new(film, statistics, &self.development, seconds)
    }

    /// Trains the integrator if there is anything to learn, and renders until the budget is spent or
    /// `cancel` says stop.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if it cannot be started, or was stopped during training.
    pub fn render(
        mut self,
        workers: &Workers,
        observer: &dyn Observer,
        cancel: &Cancel,
    ) -> Result<Rendering, Error> {
        self.train(workers, cancel)?;
        let film = self.new_film(workers)?;
        let statistics = self.render_into(&film, workers, observer, cancel)?;
        let seconds = statistics.duration.as_secs_f64();
        Ok(self.develop(&film, statistics, seconds))
    }
}

/// A sensor and its position.
fn find_sensor<'a>(
    scene: &'a LoadedScene,
    choice: &SensorChoice,
) -> Result<(usize, &'a SensorSetup), Error> {
    let sensors = scene.scene.sensors();
    let index = match choice {
        SensorChoice::Index(index) => Some(*index),
        SensorChoice::Id(id) => sensors.iter().position(|setup| setup.id.as_ref() == Some(id)),
    };
    let found = index.and_then(|index| Some((index, sensors.get(index)?)));
    found.ok_or_else(|| Error::Sensor {
        choice: choice.clone(),
        available: sensors.iter().map(|setup| setup.id.clone()).collect(),
    })
}

/// The region of the film to render.
fn find_region(setup: &SensorSetup, asked: Option<Region>) -> Result<Region, Error> {
    let crop = setup.film.crop;
    let own = Region { x: crop.x, y: crop.y, width: crop.width, height: crop.height };
    let region = asked.unwrap_or(own);
    let film = [setup.film.width, setup.film.height];
    let fits = |start: u32, length: u32, side: u32| {
        length > 0 && start.checked_add(length).is_some_and(|end| end <= side)
    };
    if fits(region.x, region.width, film[0]) && fits(region.y, region.height, film[1]) {
        Ok(region)
    } else {
        Err(Error::Region { region, film })
    }
}
