//! `cargo xtask bench`: measures Etendue and a peer in the same run on the same machine.

mod embree;
mod generated;
mod keep;
mod peer;
mod process;
mod rays;
mod scale;
mod scenes;
mod threads;

use std::path::{Path, PathBuf};

use clap::{Parser, ValueEnum};
use serde_json::json;

use crate::etendue;
use crate::workspace::root;
use process::Job;
use scenes::{SCENES, Scene};

/// What is measured.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask bench", bin_name = "cargo xtask bench")]
enum Command {
    /// Samples per second of whole renders
    Render(Arguments),
    /// Rays per second on a scene's triangles, on one thread
    Rays(rays::Arguments),
    /// Rate and memory by the number of triangles and of instances
    Scale(scale::Arguments),
    /// Two threads compared with two renders of one thread each
    Threads(threads::Arguments),
}

/// Compares renders with a peer.
#[derive(Debug, Parser)]
struct Arguments {
    /// The renderer to compare with
    #[arg(long, value_enum)]
    peer: Option<Peer>,
    /// The folder with `testcases` (the scenes) and `mitsuba3` (their copies for Mitsuba 3)
    #[arg(long, value_name = "FOLDER", default_value = "../shared/seed-scenes")]
    scenes: PathBuf,
    /// Only the scenes with these names
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Threads of both renderers
    #[arg(short = 't', long, value_name = "COUNT", default_value_t = 2)]
    threads: u32,
    /// How often every scene is measured, both renderers in turn; the median counts
    #[arg(long, value_name = "COUNT", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    #[command(flatten)]
    keeping: keep::SavedRun,
}

/// Another renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Peer {
    /// Mitsuba 3, `llvm_ad_rgb`, from PyPI
    Mitsuba,
}

/// Runs the benchmark that the arguments name.
pub(crate) fn run(arguments: &[String]) -> bool {
    let name = std::iter::once("cargo xtask bench".to_owned());
    let outcome = match Command::parse_from(name.chain(arguments.iter().cloned())) {
        Command::Render(arguments) => render(&arguments),
        Command::Rays(arguments) => rays::run(&arguments),
        Command::Scale(arguments) => scale::run(&arguments),
        Command::Threads(arguments) => threads::run(&arguments),
    };
    match outcome {
        Ok(()) => true,
        Err(problem) => {
            eprintln!("error: {problem}");
            false
        }
    }
}

fn render(arguments: &Arguments) -> Result<(), String> {
    if !etendue::build() {
        return Err("etendue does not compile".to_owned());
    }
    let python = match arguments.peer {
        Some(Peer::Mitsuba) => Some(peer::install()?),
        None => None,
    };
    let folder = root().join(&arguments.scenes);
    let table = arguments.keeping.shows_table();
    if table {
        let Arguments { threads, rounds, .. } = arguments;
        println!("Msamples/s on {threads} threads, median of {rounds} rounds");
        println!(
            "{:<14}{:>10}{:>10}{:>8}{:>12}{:>8}{:>12}{:>8}",
            "scene", "Etendue", "peer", "ratio", "load s", "peer", "peak MB", "peer"
        );
    }
    let is_wanted = |scene: &&Scene| {
        arguments.only.is_empty() || arguments.only.iter().any(|n| n == scene.name)
    };
    let mut rows = Vec::new();
    for scene in SCENES.iter().filter(is_wanted) {
        let (mut own, mut theirs) = (Vec::new(), Vec::new());
        for _ in 0..arguments.rounds {
            own.push(measure(scene, &folder, arguments.threads)?);
            if let Some(python) = &python {
                theirs.push(peer::measure(python, scene, &folder, arguments.threads)?);
            }
        }
        let measures = |rounds: &[Measured]| {
            json!({
                "msamples_per_second": column(rounds, |round| round.rate),
                "load_seconds": column(rounds, |round| round.load_seconds),
                "peak_megabytes": column(rounds, |round| round.peak_megabytes),
            })
        };
        rows.push(json!({
            "scene": scene.name, "etendue": measures(&own), "peer": measures(&theirs),
        }));
        if table {
            print_measured(scene.name, &own, &theirs);
        }
    }
    let figures = json!({ "threads": arguments.threads, "scenes": rows });
    keep::finish("render", &figures, &arguments.keeping)
}

/// A renderer's result for a scene in one round.
#[derive(Clone, Copy, Debug)]
struct Measured {
    /// Millions of samples per second.
    rate: f64,
    /// Seconds until the first sample; for Etendue this includes the start of the process.
    load_seconds: f64,
    /// The peak memory of the process.
    peak_megabytes: f64,
}

/// One measure of all rounds.
fn column(rounds: &[Measured], measure: impl Fn(&Measured) -> f64) -> Vec<f64> {
    rounds.iter().map(measure).collect()
}

/// A row of the table of whole renders.
fn print_measured(name: &str, own: &[Measured], theirs: &[Measured]) {
    let measures: [fn(&Measured) -> f64; 3] =
        [|round| round.rate, |round| round.load_seconds, |round| round.peak_megabytes];
    let [own, theirs] = [own, theirs]
        .map(|rounds| measures.map(|measure| median(column(rounds, measure)).unwrap_or(f64::NAN)));
    println!(
        "{name:<14}{:>10.3}{:>10.3}{:>8.2}{:>12.3}{:>8.3}{:>12.0}{:>8.0}",
        own[0],
        theirs[0],
        own[0] / theirs[0],
        own[1],
        theirs[1],
        own[2],
        theirs[2]
    );
}

/// The rate comes from the difference of two runs, so that start-up and loading cancel.
fn measure(scene: &Scene, folder: &Path, threads: u32) -> Result<Measured, String> {
    let path = folder.join("testcases").join(scene.path);
    let render = |samples: u32| {
        let job = Job { scene: &path, size: scene.size, samples, threads, filter: Some("box") };
        process::start(&job, scene.name)?.finish()
    };
    let [few, many] = scene.counts;
    let (short, long) = (render(few)?, render(many)?);
    Ok(Measured {
        rate: scene.millions_between() / (long.wall_seconds - short.wall_seconds),
        load_seconds: long.load_seconds,
        peak_megabytes: long.peak_megabytes,
    })
}

/// The median, the upper of two middle values; `None` without values.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        Command::command().debug_assert();
    }

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median(vec![3.0]), Some(3.0));
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(Vec::new()), None);
    }
}
