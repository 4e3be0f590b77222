//! `etendue render`: renders scenes to picture files.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use etendue::{
    EngineError, Error, FilmSums, LoadTimes, Region, RenderJob, RenderOptions, Rendering,
    SampleChoice, SampleId, SamplesPerPixel, SensorChoice, Statistics, SumsFile, Workers,
};
use serde_json::json;

use super::scene::SceneArguments;
use crate::checkpoint_writer::{CheckpointArguments, CheckpointWriter, End};
use crate::display::DisplayArguments;
use crate::failure::{Failure, Status};
use crate::output::{self, Target};
use crate::outputs::{Outputs, Product};
use crate::progress::{ProgressDisplay, ProgressMode};
use crate::signals::Signals;
use crate::{diagnostics, memory, origin, parsers, replay, report, resume, terminal, text};

/// The arguments of `etendue render`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Scene files
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// Output file: exr, png, jpg, hdr, pfm, bmp, tiff, npy or npz by extension, part for the
    /// samples' sums, or a folder. Repeat for several files [default: the scene's name, or its folder's
    /// if it is called scene, with .exr and .png]
    #[arg(short = 'o', long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Samples per pixel; overrides the scene's value
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,
    /// Stop after this time: 90s, 10m, 1h30m. Without --spp, take as many samples as fit
    #[arg(long, value_name = "TIME", value_parser = parsers::time)]
    time: Option<Duration>,
    /// Render only some samples of each pixel, from index A to B - 1 or part I of N, and write a
    /// .part file for `etendue merge` [default name: the scene's with .A-B.part or .I-of-N.part]
    #[arg(long, value_name = "A..B|I/N", value_parser = parsers::samples)]
    samples: Option<SampleChoice>,
    /// Seed of the random numbers
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,
    /// Region of the film to render, in pixels
    #[arg(long, value_name = "X,Y,W,H", value_parser = parsers::crop)]
    crop: Option<Region>,
    /// Sensor to render: an index from 0, or an id
    #[arg(short = 's', long, value_name = "SENSOR", default_value = "0")]
    sensor: String,
    /// Add the variance of each pixel's mean as layers of the EXR file
    #[arg(long)]
    variance: bool,
    /// Render one sample, print its values, and write no picture
    #[arg(long, value_name = "X,Y,INDEX", value_parser = parsers::sample_id)]
    replay: Option<SampleId>,
    /// Skip scenes whose output files exist, are finished and are of this scene as it is now
    #[arg(long)]
    skip_existing: bool,
    /// Replace files with the default names even if they are of another scene or not of Etendue
    #[arg(long)]
    overwrite: bool,
    /// Print one line of JSON per second on standard output, for other programs
    #[arg(long)]
    json_progress: bool,
    #[command(flatten)]
    display: DisplayArguments,
    #[command(flatten)]
    checkpoints: CheckpointArguments,
    #[command(flatten)]
    scene: SceneArguments,
}

/// Renders every scene in turn.
pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let signals = Signals::install()
        .map_err(|error| Failure::failed(format!("cannot install signal handlers: {error}")))?;
    let outputs = outputs(arguments)?;
    let preview = arguments.checkpoints.preview()?;
    let named = outputs.iter().flat_map(Outputs::paths);
    output::check_distinct(named.chain(preview.iter().map(|target| target.path.as_path())))?;
    let workers = arguments.scene.workers()?;
    let host = Host { arguments, workers: &workers, signals: &signals, preview: preview.as_ref() };
    let mut worst = Status::Success;
    for (scene, outputs) in arguments.scenes.iter().zip(&outputs) {
        worst = worst.max(host.render(scene, outputs)?);
        if let Some(signal) = signals.received() {
            return Ok(Status::Stopped(signal));
        }
    }
    Ok(worst)
}

/// The output files of every scene, all checked to be writable.
fn outputs(arguments: &Arguments) -> Result<Vec<Outputs>, Failure> {
    if arguments.replay.is_some() {
        return Ok(vec![Outputs::default(); arguments.scenes.len()]);
    }
    let product = match arguments.samples {
        Some(_) => Product::Parts,
        None => Product::Pictures,
    };
    let folder = match arguments.output.as_slice() {
        [] => Some(Path::new("")),
        [only] if only.is_dir() => Some(only.as_path()),
        _ => None,
    };
    let Some(folder) = folder else {
        if arguments.scenes.len() > 1 {
            return Err(Failure::bad_input("several scenes need a folder as --output"));
        }
        return Ok(vec![Outputs::new(&arguments.output, product)?]);
    };
    let mut all: Vec<Outputs> = Vec::new();
    for scene in &arguments.scenes {
        let names = output::default_names(scene, folder, arguments.samples.as_ref());
        let outputs = Outputs::new(&names, product)?;
        if !arguments.overwrite {
            outputs.check_origins(&origin::name_of_scene(scene))?;
        }
        if all.contains(&outputs) {
            let name = text::path(&names[0]);
            return Err(Failure::bad_input(format!("two scenes would be written to {name}")));
        }
        all.push(outputs);
    }
    Ok(all)
}

/// What all scenes of a run share.
struct Host<'a> {
    arguments: &'a Arguments,
    workers: &'a Workers,
    signals: &'a Signals,
    preview: Option<&'a Target>,
}

impl Host<'_> {
    fn render(&self, path: &Path, outputs: &Outputs) -> Result<Status, Failure> {
        let arguments = self.arguments;
        self.signals.leave_at_once();
        let checkpoint = outputs.checkpoint();
        let find_checkpoint = || match &checkpoint {
            Some(checkpoint) => resume::find(checkpoint, arguments.checkpoints.resume),
            None => Ok(None),
        };
        let is_finished = arguments.skip_existing && outputs.exist();
        let mut header = if is_finished { None } else { find_checkpoint()? };
        let loaded = arguments.scene.load(path, self.workers)?;
        diagnostics::show(&loaded.diagnostics, arguments.scene.detail());
        let Some(loaded_scene) = &loaded.scene else {
            return Ok(Status::BadInput);
        };
        if is_finished {
            if outputs.may_be_of(&loaded_scene.hash()) {
                self.say(&format!("{}: skipped, already finished", outputs.names()));
                return Ok(Status::Success);
            }
            self.say(&format!("{}: of another scene, rendered again", outputs.names()));
            header = find_checkpoint()?;
        }
        let planned = header.as_ref().map(|header| header.record.planned_samples);
        let job = RenderJob::new(loaded_scene, &options(arguments, path, planned));
        let mut job = job.map_err(|error| failure(path, error))?;
        job.train(self.workers, self.signals.cancel()).map_err(|error| failure(path, error))?;
        if let Some(id) = arguments.replay {
            replay::show(&job, id)?;
            return Ok(Status::Success);
        }
        if !arguments.scene.quiet {
            report::memory(&loaded_scene.scene, &job);
        }
        let film = match (&checkpoint, &header) {
            (Some(checkpoint), Some(header)) => {
                let film = resume::read(checkpoint, header, &job)?;
                let held = text::counted(film.samples_per_pixel().least as usize, "sample");
                let name = text::path(checkpoint.path());
                self.say(&format!("resuming from {name}: {held} per pixel"));
                film
            }
            _ => job.new_film(self.workers).map_err(|error| failure(path, error))?,
        };
        let checkpoint = checkpoint.filter(|_| !arguments.checkpoints.no_checkpoint);
        if let Some(checkpoint) = &checkpoint {
            checkpoint.remove_abandoned();
        }
        let seconds_before = header.map_or(0.0, |header| header.record.seconds);
        let run = Run { job: &job, film: &film, outputs, checkpoint, seconds_before };
        self.render_into_film(&run, path, &loaded.times)
    }

    /// Renders, writes checkpoints meanwhile, and writes the outputs.
    fn render_into_film(
        &self,
        run: &Run<'_>,
        path: &Path,
        load_times: &LoadTimes,
    ) -> Result<Status, Failure> {
        let arguments = self.arguments;
        let mode = match (arguments.json_progress, arguments.scene.quiet) {
            (true, _) => ProgressMode::Json,
            (false, true) => ProgressMode::Silent,
            (false, false) => ProgressMode::Default,
        };
        let _locks = run.outputs.lock()?;
        let display = ProgressDisplay::new(mode, self.signals.cancel());
        let writer = CheckpointWriter {
            job: run.job,
            film: run.film,
            checkpoint: run.checkpoint.as_ref(),
            preview: self.preview,
            arguments: &arguments.checkpoints,
            display: &display,
            seconds_before: run.seconds_before,
            started: Instant::now(),
        };
        display.event(
            "start",
            &json!({
                "scene": path.display().to_string(),
                "film_bytes": run.job.memory_needed(),
            }),
        );
        self.signals.finish_gracefully();
        let end = End::default();
        let statistics = thread::scope(|scope| {
            scope.spawn(|| writer.run(&end));
            let _end = end.guard();
            run.job.render_into(run.film, self.workers, &display, self.signals.cancel())
        });
        display.finish();
        let statistics = statistics.map_err(|error| failure(path, error))?;
        let write_started = Instant::now();
        let (status, rendering) = self.write(run, &writer, statistics);
        report::clamped(&rendering);
        replay::report(&rendering.statistics.defects);
        report::long_paths(&rendering.statistics);
        if status == Status::Success && !arguments.scene.quiet {
            report::written(&rendering, run.outputs);
        }
        if arguments.scene.verbose {
            report::times(load_times, &rendering.statistics, write_started.elapsed());
        }
        let SamplesPerPixel { least, most } = rendering.statistics.samples_per_pixel;
        display.event("end", &json!({
            "files": run.outputs.paths().map(|path| path.display().to_string()).collect::<Vec<_>>(),
            "samples_per_pixel": [least, most],
            "stopped_early": rendering.statistics.cancelled,
            "written": status == Status::Success,
        }));
        Ok(status.max(display.status()))
    }

    /// Writes the outputs, and removes the checkpoint once all of them are safely written.
    fn write(
        &self,
        run: &Run<'_>,
        writer: &CheckpointWriter<'_>,
        statistics: Statistics,
    ) -> (Status, Rendering) {
        let seconds = writer.seconds();
        let stopped = statistics.cancelled;
        // After a signal there may be little time left, so the checkpoint comes first.
        let mut is_saved = stopped && writer.write_checkpoint();
        let rendering = run.job.develop(run.film, statistics, seconds);
        let mut status = self.workers.run(|| run.outputs.write_pictures(&rendering));
        if !stopped {
            status = status.max(run.outputs.write_parts(run.film, &run.job.record(seconds)));
            let is_safe = status == Status::Success;
            if !is_safe || self.arguments.checkpoints.keep_checkpoint {
                is_saved = writer.write_checkpoint();
            } else if let Some(checkpoint) = &run.checkpoint
                && let Err(error) = checkpoint.remove()
            {
                let name = text::path(checkpoint.path());
                terminal::warning(&format!("cannot remove the obsolete {name}: {error}"));
            }
        }
        if let Some(checkpoint) = run.checkpoint.as_ref().filter(|_| is_saved) {
            let name = text::path(checkpoint.path());
            self.say(&format!("{name} holds the samples: --resume continues from them"));
        }
        (status, rendering)
    }

    /// Prints a message unless `--quiet` is given.
    fn say(&self, line: &str) {
        if !self.arguments.scene.quiet {
            terminal::message_line(line);
        }
    }
}

/// The render of one scene.
struct Run<'a> {
    job: &'a RenderJob,
    film: &'a FilmSums,
    outputs: &'a Outputs,
    /// `None` to write no checkpoints.
    checkpoint: Option<SumsFile>,
    /// Wall time of the earlier runs, in seconds.
    seconds_before: f64,
}

/// The library's options. `planned` is the number of samples planned by the run to resume.
fn options(arguments: &Arguments, scene: &Path, planned: Option<u32>) -> RenderOptions {
    RenderOptions {
        sensor: SensorChoice::from(arguments.sensor.as_str()),
        region: arguments.crop,
        samples_per_pixel: arguments.spp,
        samples: arguments.samples.clone(),
        planned_samples: planned,
        time_limit: arguments.time,
        seed: arguments.seed,
        threads: arguments.scene.threads,
        variance: arguments.variance,
        exposure: arguments.display.exposure,
        tone_map: arguments.display.tone_map(),
        scene_name: origin::name_of_scene(scene),
        memory_limit: arguments.scene.memory.or_else(memory::available),
    }
}

/// Converts an error of the library. All but a failure to start threads are due to the input.
fn failure(scene: &Path, error: Error) -> Failure {
    let message = format!("{}: {error}", text::path(scene));
    match error {
        Error::Engine(EngineError::Threads(_)) => Failure::failed(message),
        _ => Failure::bad_input(message),
    }
}
