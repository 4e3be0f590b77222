//! `cargo xtask bench threads`: compares two threads with two renders of one thread each.

use std::path::PathBuf;

use clap::Parser;
use serde_json::json;

use super::keep::{self, SavedRun};
use super::process::{self, Job};
use crate::etendue;
use crate::workspace::root;

/// Renders a scene on two threads, and in turn as two simultaneous renders on one thread each. The
/// ratio of the rates shows what threads cost each other: waiting, shared cache lines, idle time at
/// the end.
#[derive(Debug, Parser)]
pub(super) struct Arguments {
    /// The scene
    #[arg(
        long,
        value_name = "FILE",
        default_value = "../shared/seed-scenes/testcases/kitchen/scene.xml"
    )]
    scene: PathBuf,
    /// Samples per pixel, at 480x270 pixels; each of the two renders takes half
    #[arg(long, value_name = "COUNT", default_value_t = 32, value_parser = clap::value_parser!(u32).range(2..))]
    spp: u32,
    /// How often both are measured, in turn; the best of each counts
    #[arg(long, value_name = "COUNT", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    #[command(flatten)]
    keeping: SavedRun,
}

/// Two threads must reach this fraction of the rate of two processes.
const LEAST_SHARE: f64 = 0.97;

/// Runs the benchmark.
pub(super) fn run(arguments: &Arguments) -> Result<(), String> {
    if !etendue::build() {
        return Err("etendue does not compile".to_owned());
    }
    let scene = root().join(&arguments.scene);
    let job =
        |samples, threads| Job { scene: &scene, size: [480, 270], samples, threads, filter: None };
    let (mut together, mut apart) = (Vec::new(), Vec::new());
    for _ in 0..arguments.rounds {
        let one = process::start(&job(arguments.spp, 2), "threads")?.finish()?;
        together.push(one.samples_per_second * 1e-6);
        let half = job(arguments.spp.div_ceil(2), 1);
        let two = [process::start(&half, "first")?, process::start(&half, "second")?];
        let [first, second] = two.map(process::Running::finish);
        apart.push((first?.samples_per_second + second?.samples_per_second) * 1e-6);
        if arguments.keeping.shows_table() {
            let last = |rates: &[f64]| rates.last().copied().unwrap_or_default();
            println!(
                "two threads {:.3} Msamples/s, two processes {:.3}",
                last(&together),
                last(&apart)
            );
        }
    }
    let best = |rates: &[f64]| rates.iter().copied().fold(0.0, f64::max);
    let share = best(&together) / best(&apart);
    if arguments.keeping.shows_table() {
        println!("two threads reach {:.1} % of two processes", share * 100.0);
    }
    let figures = json!({
        "scene": arguments.scene,
        "samples_per_pixel": arguments.spp,
        "two_threads_msamples_per_second": together,
        "two_processes_msamples_per_second": apart,
        "share": share,
        "least_share": LEAST_SHARE,
    });
    keep::finish("threads", &figures, &arguments.keeping)?;
    if share < LEAST_SHARE {
        return Err(format!("less than {:.0} %", LEAST_SHARE * 100.0));
    }
    Ok(())
}
