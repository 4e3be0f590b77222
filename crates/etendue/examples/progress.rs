//! Renders with progress on the terminal and stops when Enter is pressed or the time is up:
//! `progress SCENE.xml [SECONDS]`.
#![allow(
    clippy::disallowed_macros,
    clippy::disallowed_methods,
    reason = "an example is a host: it prints, and reads arguments"
)]

use std::error::Error;
use std::io;
use std::path::Path;
use std::thread;
use std::time::Duration;

use etendue::{
    Cancel, Files, FinishedPass, Observer, Progress, RenderJob, RenderOptions, SceneOptions,
    Workers, load,
};

/// Prints how far the render is.
struct Terminal;

impl Observer for Terminal {
    fn progress(&self, progress: &Progress) {
        let percent = 100.0 * progress.fraction();
        // No estimate exists before the first sample.
        let left = progress.time_left().unwrap_or_default().as_secs_f64();
        eprint!("\r{percent:5.1} %, {left:.1} s left, {:.1e} samples/s ", progress.rate());
    }

    fn pass_finished(&self, pass: &FinishedPass<'_>) {
        // A viewer would develop `pass.film` here.
        eprintln!("\rpass done: {} samples per pixel", pass.samples_per_pixel);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().ok_or("usage: progress SCENE.xml [SECONDS]")?;
    let seconds: f64 = arguments.next().map_or(Ok(10.0), |seconds| seconds.parse())?;

    // Loading and rendering share one thread pool.
    let workers = Workers::new(None)?;
    let folder = std::env::current_dir()?;
    let options = SceneOptions::default();
    let loaded = workers.run(|| load(Path::new(&scene), folder, &Files::default(), &options));
    let scene = loaded.scene.ok_or_else(|| loaded.diagnostics.to_string())?;

    let time_limit = Some(Duration::try_from_secs_f64(seconds)?);
    let job = RenderJob::new(&scene, &RenderOptions { time_limit, ..RenderOptions::default() })?;

    // Any thread may stop the render; the samples so far are kept.
    let cancel = Cancel::new();
    let stop = cancel.clone();
    thread::spawn(move || {
        let mut line = String::new();
        // At end of input, nobody can press Enter.
        if io::stdin().read_line(&mut line).is_ok_and(|length| length > 0) {
            stop.cancel();
        }
    });
    let rendering = job.render(&workers, &Terminal, &cancel)?;
    let samples = rendering.statistics.samples_per_pixel;
    println!("{} to {} samples per pixel", samples.least, samples.most);
    Ok(())
}
