//! `etendue render`: from scenes to picture files.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use etendue::{
    EngineError, Error, Region, RenderOptions, Rendering, SampleId, SensorChoice, Shot, Workers,
};
use rayon::prelude::*;

use super::scene::SceneArguments;
use crate::failure::{Failure, Status};
use crate::output::{self, Target};
use crate::progress::{ProgressDisplay, Quiet};
use crate::signals::Signals;
use crate::{findings, memory, parsers, replay, report, terminal};

/// What is rendered, how, and to where.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Scene files
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    /// Write here: exr, png, jpg, hdr, pfm, bmp or tiff by extension, or a folder; several times
    /// for several files [default: the scene's name with .exr and .png]
    #[arg(short = 'o', long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Samples per pixel, instead of the scene's number
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,
    /// Stop after this time: 90s, 10m, 1h30m. Without --spp, as many samples as fit
    #[arg(long, value_name = "TIME", value_parser = parsers::time)]
    time: Option<Duration>,
    /// Choose other random numbers
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,
    /// The part of the film to render, in pixels
    #[arg(long, value_name = "X,Y,W,H", value_parser = parsers::crop)]
    crop: Option<Region>,
    /// Which of the scene's sensors: a number from 0, or an id
    #[arg(short = 's', long, value_name = "SENSOR", default_value = "0")]
    sensor: String,
    /// Add the variance of every pixel's mean, as layers of the EXR file
    #[arg(long)]
    variance: bool,
    /// Take one sample, print what it says, and write no picture
    #[arg(long, value_name = "X,Y,INDEX", value_parser = parsers::sample_id)]
    replay: Option<SampleId>,
    #[command(flatten)]
    scene: SceneArguments,
}

/// Renders every scene in turn.
pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let signals = Signals::install()
        .map_err(|error| Failure::failed(format!("cannot listen to signals: {error}")))?;
    let targets = targets(arguments)?;
    let workers = arguments.scene.workers()?;
    let mut worst = Status::Fine;
    for (scene, targets) in arguments.scenes.iter().zip(&targets) {
        worst = worst.max(render_scene(arguments, scene, targets, &workers, &signals)?);
        if let Some(signal) = signals.received() {
            return Ok(Status::Stopped(signal));
        }
    }
    Ok(worst)
}

/// The files of every scene, all of them checked.
fn targets(arguments: &Arguments) -> Result<Vec<Vec<Target>>, Failure> {
    if arguments.replay.is_some() {
        return Ok(vec![Vec::new(); arguments.scenes.len()]);
    }
    let folder = match arguments.output.as_slice() {
        [] => Some(Path::new("")),
        [only] if only.is_dir() => Some(only.as_path()),
        _ => None,
    };
    let Some(folder) = folder else {
        if arguments.scenes.len() > 1 {
            return Err(Failure::bad_input("several scenes need a folder after --output"));
        }
        let named: Result<_, _> = arguments.output.iter().map(|path| Target::new(path)).collect();
        return Ok(vec![named?]);
    };
    let mut all: Vec<Vec<Target>> = Vec::new();
    for scene in &arguments.scenes {
        let names = output::default_names(scene, folder);
        let targets: Vec<Target> =
            names.iter().map(|path| Target::new(path)).collect::<Result<_, _>>()?;
        if all.contains(&targets) {
            let name = targets[0].path.display();
            return Err(Failure::bad_input(format!("two scenes would be written to {name}")));
        }
        all.push(targets);
    }
    Ok(all)
}

fn render_scene(
    arguments: &Arguments,
    path: &Path,
    targets: &[Target],
    workers: &Workers,
    signals: &Signals,
) -> Result<Status, Failure> {
    signals.leave_at_once();
    let loaded = arguments.scene.load(path, workers)?;
    findings::show(&loaded.findings, arguments.scene.detail());
    let Some(content) = &loaded.content else {
        return Ok(Status::BadInput);
    };
    let shot = Shot::new(content, &options(arguments)).map_err(|error| failure(path, error))?;
    if let Some(id) = arguments.replay {
        replay::show(&shot, id)?;
        return Ok(Status::Fine);
    }
    let progress = ProgressDisplay::new(Quiet(arguments.scene.quiet));
    signals.finish_gracefully();
    let rendering = shot.render(workers, &progress, signals.cancel());
    progress.finish();
    let rendering = rendering.map_err(|error| failure(path, error))?;
    let write_started = Instant::now();
    let written = workers.run(|| write(&rendering, targets));
    replay::report(&rendering.statistics.defects);
    if !arguments.scene.quiet {
        report::written(&rendering, targets);
    }
    if arguments.scene.verbose {
        report::times(&loaded.times, &rendering.statistics, write_started.elapsed());
    }
    Ok(written)
}

/// Writes every file that can be written, several at once, and tells why of the others.
fn write(rendering: &Rendering, targets: &[Target]) -> Status {
    let write_one = |target: &Target| match target.write(rendering.encode(target.format)) {
        Ok(()) => Status::Fine,
        Err(failure) => {
            terminal::error(&failure.message);
            failure.status
        }
    };
    targets.par_iter().map(write_one).max().unwrap_or(Status::Fine)
}

fn options(arguments: &Arguments) -> RenderOptions {
    RenderOptions {
        sensor: SensorChoice::from(arguments.sensor.as_str()),
        region: arguments.crop,
        samples_per_pixel: arguments.spp,
        time_limit: arguments.time,
        seed: arguments.seed,
        threads: arguments.scene.threads,
        variance: arguments.variance,
        memory_limit: memory::available(),
    }
}

/// An error of the library: all but the want of threads is due to what was asked for.
fn failure(scene: &Path, error: Error) -> Failure {
    let message = format!("{}: {error}", scene.display());
    match error {
        Error::Engine(EngineError::Threads(_)) => Failure::failed(message),
        _ => Failure::bad_input(message),
    }
}
