//! One camera of one scene, rendered.

use std::path::{Path, PathBuf};

use etendue_document::{MemoryResources, Node, Resources};
use etendue_engine::{
    Budget, Camera, FilmRecord, FilmSums, Host, Job, Region, SampleSource, Statistics, render_into,
};
use etendue_sampling::SamplerSpec;
use etendue_scene::SensorSetup;

use crate::development::{Development, hexadecimal};
use crate::load::LoadedScene;
use crate::options::DEFAULT_MEMORY_LIMIT;
use crate::{
    Cancel, Error, Files, Loaded, Observer, RenderOptions, Rendering, SceneOptions, SensorChoice,
    Silent, Workers, load, load_node, load_text,
};

/// Reads a scene file from disk and renders it: the whole way on one page.
///
/// Relative paths start at the current folder. Warnings are dropped here; [`load`] keeps them.
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

/// Renders a scene that is a text. It cannot name files.
///
/// # Errors
///
/// As [`render_file`].
pub fn render_text(
    text: &str,
    scene_options: &SceneOptions,
    options: &RenderOptions,
) -> Result<Rendering, Error> {
    let nothing: &dyn Resources = &MemoryResources::default();
    render_loaded(options, || load_text(text, PathBuf::new(), nothing, scene_options))
}

/// Renders a scene that was built in code. Files that it names are sought in the current folder.
///
/// # Errors
///
/// As [`render_file`].
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
    let content = loaded.content.ok_or_else(|| Error::Scene(Box::new(loaded.diagnostics)))?;
    RenderJob::new(&content, options)?.render(&workers, &Silent, &Cancel::new())
}

/// A camera that is ready to render.
pub struct RenderJob<'a> {
    camera: Camera<'a>,
    content: &'a LoadedScene,
    setup: &'a SensorSetup,
    job: Job,
    planned_samples: u32,
}

impl<'a> RenderJob<'a> {
    /// Chooses a camera of the scene and what to spend on it.
    ///
    /// # Errors
    ///
    /// [`Error::Sensor`] if there is no such camera; [`Error::Region`] if the part to render does
    /// not lie within its film; [`Error::Samples`] if the samples do not lie within the plan.
    pub fn new(content: &'a LoadedScene, options: &RenderOptions) -> Result<Self, Error> {
        let setup = find_sensor(content, &options.sensor)?;
        let own_count = setup.sampler.rounded_sample_count();
        // A time alone means as many samples as it has room for.
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
        let sampler = SamplerSpec::new(setup.sampler.kind(), planned, seed);
        let job = Job {
            region: find_region(setup, options.region)?,
            first_sample,
            budget: Budget { samples_per_pixel: end, time: options.time_limit },
            variance: options.variance,
            memory_limit: options.memory_limit.unwrap_or(DEFAULT_MEMORY_LIMIT),
        };
        let camera = Camera::new(&content.scene, setup, sampler, &*content.integrator);
        Ok(Self { camera, content, setup, job, planned_samples: planned })
    }

    /// Where its samples come from, for replaying one.
    pub fn camera(&self) -> &Camera<'a> {
        &self.camera
    }

    /// The pixels that are rendered and the budget they are given.
    pub fn job(&self) -> &Job {
        &self.job
    }

    /// The camera, its film and its sampler, as the scene says.
    pub fn setup(&self) -> &'a SensorSetup {
        self.setup
    }

    /// The bytes of memory that the film and the finished picture take; the scene has its own.
    pub fn memory_needed(&self) -> u64 {
        FilmSums::memory_needed(&self.job, &self.camera)
    }

    /// Everything that decides the picture, by name. Sums of two renders belong together if these
    /// are equal.
    pub fn identity(&self) -> Vec<(String, String)> {
        let sampler = self.camera.sampler();
        let Region { x, y, width, height } = self.job.region;
        let [columns, rows] = [self.setup.film.width, self.setup.film.height];
        let sensors = self.content.scene.sensors();
        let sensor = sensors.iter().position(|setup| std::ptr::eq(setup, self.setup));
        let own = [
            ("version of Etendue", env!("CARGO_PKG_VERSION").to_owned()),
            ("scene and its files", hexadecimal(&self.content.scene.content_hash())),
            ("sensor", sensor.unwrap_or(0).to_string()),
            ("film", format!("{columns}x{rows}")),
            ("pixels", format!("{width}x{height} from ({x}, {y})")),
            ("sampler", format!("{:?}", sampler.kind())),
            ("planned samples", self.planned_samples.to_string()),
            ("seed", sampler.seed().to_string()),
            ("layers", self.camera.channels().join(", ")),
            ("variance", self.job.variance.to_string()),
        ];
        let own = own.map(|(name, value)| (name.to_owned(), value));
        own.into_iter().chain(self.content.settings.iter().cloned()).collect()
    }

    /// What a file says about sums of this job that took so long.
    pub fn record(&self, seconds: f64) -> FilmRecord {
        FilmRecord {
            identity: self.identity(),
            notes: self.development().to_notes(),
            planned_samples: self.planned_samples,
            seconds,
        }
    }

    fn development(&self) -> Development {
        let hash = self.content.scene.content_hash();
        Development::new(self.setup, &hash, self.camera.sampler().seed())
    }

    /// Sums without samples.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if they would take too much memory.
    pub fn new_film(&self, workers: &Workers) -> Result<FilmSums, Error> {
        Ok(FilmSums::new(&self.job, &self.camera, workers.thread_count())?)
    }

    /// Adds samples to sums, which may hold some of an earlier run, until the budget is spent or
    /// `cancel` says stop.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if it cannot be started.
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

    /// The picture of sums of this job; `seconds` is the wall time of all runs that made them.
    pub fn develop(&self, film: &FilmSums, statistics: Statistics, seconds: f64) -> Rendering {
        Rendering::new(film, statistics, &self.development(), seconds)
    }

    /// Renders until the budget is spent or `cancel` says stop.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if it cannot be started.
    pub fn render(
        &self,
        workers: &Workers,
        observer: &dyn Observer,
        cancel: &Cancel,
    ) -> Result<Rendering, Error> {
        let film = self.new_film(workers)?;
        let statistics = self.render_into(&film, workers, observer, cancel)?;
        let seconds = statistics.duration.as_secs_f64();
        Ok(self.develop(&film, statistics, seconds))
    }
}

fn find_sensor<'a>(
    content: &'a LoadedScene,
    choice: &SensorChoice,
) -> Result<&'a SensorSetup, Error> {
    let sensors = content.scene.sensors();
    let found = match choice {
        SensorChoice::Index(index) => sensors.get(*index),
        SensorChoice::Id(id) => sensors.iter().find(|setup| setup.id.as_ref() == Some(id)),
    };
    found.ok_or_else(|| Error::Sensor {
        choice: choice.clone(),
        available: sensors.iter().map(|setup| setup.id.clone()).collect(),
    })
}

/// The part of the film that is rendered.
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
