//! `cargo xtask bench`: measurements beside a peer, in the same run on the same machine.

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
use std::process::Stdio;
use std::time::Instant;

use clap::{Parser, ValueEnum};
use serde_json::json;

use crate::workspace::{cargo, root};
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
    /// Two threads beside two renders of one thread each
    Threads(threads::Arguments),
}

/// Renders beside a peer.
#[derive(Debug, Parser)]
struct Arguments {
    /// The renderer to compare with
    #[arg(long, value_enum)]
    peer: Option<Peer>,
    /// The folder with `testcases` (the scenes) and `mitsuba3` (their copies for Mitsuba 3)
    #[arg(long, value_name = "FOLDER", default_value = "../shared/seed-scenes")]
    scenes: PathBuf,
    /// The scenes of these names only
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Threads of both renderers
    #[arg(short = 't', long, value_name = "COUNT", default_value_t = 2)]
    threads: u32,
    /// How often every scene is measured, both renderers in turn; the median counts
    #[arg(long, value_name = "COUNT", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    #[command(flatten)]
    keeping: keep::Keeping,
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
    let binary = build()?;
    let python = match arguments.peer {
        Some(Peer::Mitsuba) => Some(peer::install()?),
        None => None,
    };
    let folder = root().join(&arguments.scenes);
    let table = arguments.keeping.shows_table();
    if table {
        let Arguments { threads, rounds, .. } = arguments;
        println!("Msamples/s on {threads} threads, median of {rounds} rounds");
        println!("{:<14}{:>10}{:>10}{:>8}", "scene", "Etendue", "peer", "ratio");
    }
    let is_wanted = |scene: &&Scene| {
        arguments.only.is_empty() || arguments.only.iter().any(|n| n == scene.name)
    };
    let mut rows = Vec::new();
    for scene in SCENES.iter().filter(is_wanted) {
        let (mut own, mut theirs) = (Vec::new(), Vec::new());
        for _ in 0..arguments.rounds {
            own.push(measure(&binary, scene, &folder, arguments.threads)?);
            if let Some(python) = &python {
                theirs.push(peer::measure(python, scene, &folder, arguments.threads)?);
            }
        }
        rows.push(json!({
            "scene": scene.name, "msamples_per_second": &own, "peer_msamples_per_second": &theirs,
        }));
        if table {
            print_rates(scene.name, median(own), &theirs);
        }
    }
    let figures = json!({ "threads": arguments.threads, "scenes": rows });
    keep::finish("render", &figures, &arguments.keeping)
}

/// A line of the table of whole renders.
fn print_rates(name: &str, own: f64, theirs: &[f64]) {
    if theirs.is_empty() {
        println!("{name:<14}{own:>10.3}");
    } else {
        let theirs = median(theirs.to_vec());
        println!("{name:<14}{own:>10.3}{theirs:>10.3}{:>8.2}", own / theirs);
    }
}

/// Compiles the command as users get it; returns its path.
fn build() -> Result<PathBuf, String> {
    let build = ["build", "--release", "--package", "etendue-cli", "--quiet"];
    let status = cargo().args(build).status().map_err(|error| error.to_string())?;
    let target =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let binary = target.join("release").join(format!("etendue{}", std::env::consts::EXE_SUFFIX));
    if status.success() { Ok(binary) } else { Err("etendue does not compile".to_owned()) }
}

/// Millions of samples per second: the difference of two runs, so that start-up and loading drop
/// out.
fn measure(binary: &Path, scene: &Scene, folder: &Path, threads: u32) -> Result<f64, String> {
    let seconds = |count: u32| {
        let [width, height] = scene.size;
        let output = std::env::temp_dir().join(format!("etendue-bench-{}.pfm", std::process::id()));
        let mut command = std::process::Command::new(binary);
        command.arg("render").arg(folder.join("testcases").join(scene.path));
        command.args(["--size", &format!("{width}x{height}"), "--filter", "box", "--quiet"]);
        command.args(["--spp", &count.to_string(), "--threads", &threads.to_string()]);
        command.arg("--output").arg(&output).stdin(Stdio::null());
        let started = Instant::now();
        let status = command.status().map_err(|error| format!("cannot run etendue: {error}"))?;
        let seconds = started.elapsed().as_secs_f64();
        // The picture is of no interest, and may not even be there.
        let _ = std::fs::remove_file(&output);
        if status.success() { Ok(seconds) } else { Err(format!("{} does not render", scene.name)) }
    };
    let [few, many] = scene.counts;
    let difference = seconds(many)? - seconds(few)?;
    Ok(scene.millions_between() / difference)
}

/// The middle of some numbers; the upper one of the two in the middle.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
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
        assert_eq!(median(vec![3.0]), 3.0);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
    }
}
