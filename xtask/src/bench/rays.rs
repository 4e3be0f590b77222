//! `cargo xtask bench rays`: rays per second on a scene's triangles, on one thread.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::{Parser, ValueEnum};

use super::embree;
use super::keep::{self, SavedRun};
use crate::generate;
use crate::workspace::{cargo, root};

/// Compares ray tracing with a peer.
#[derive(Debug, Parser)]
pub(super) struct Arguments {
    /// The scene whose triangles and first camera are used
    #[arg(
        long,
        value_name = "FILE",
        default_value = "../shared/seed-scenes/testcases/kitchen/scene.xml"
    )]
    scene: PathBuf,
    /// The library to compare with, given the same triangles and the same rays
    #[arg(long, value_enum)]
    peer: Option<Peer>,
    /// How often every kind of rays is traced, all hierarchies in turn; the best round counts
    #[arg(long, value_name = "COUNT", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// The build preset of our hierarchy: fast, balanced, spatial
    #[arg(long, value_name = "NAME", default_value = "balanced")]
    preset: String,
    /// Also trace this many rays at a time with our hierarchy, as the renderer does
    #[arg(long, value_name = "COUNT")]
    batch: Option<usize>,
    #[command(flatten)]
    keeping: SavedRun,
}

/// Another library.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Peer {
    /// Embree 4, fast and robust, from PyPI
    Embree,
}

/// Runs the benchmark.
pub(super) fn run(arguments: &Arguments) -> Result<(), String> {
    let library = match arguments.peer {
        Some(Peer::Embree) => Some(embree::install()?),
        None => None,
    };
    let triangles = triangles_of(&root().join(&arguments.scene))?;
    let bench = ["bench", "--quiet", "--package", "etendue-bvh", "--bench", "rays"];
    let mut command = cargo();
    command.args(bench).arg("--").arg(&triangles);
    command.args(["--rounds", &arguments.rounds.to_string(), "--preset", &arguments.preset]);
    if let Some(library) = &library {
        command.arg("--embree").arg(library);
        command.env("LD_LIBRARY_PATH", library.parent().unwrap_or(Path::new(".")));
    }
    if let Some(count) = arguments.batch {
        command.args(["--batch", &count.to_string()]);
    }
    if !arguments.keeping.wants_json() {
        return check(&mut command);
    }
    let output = command.arg("--json").stderr(Stdio::inherit()).output();
    let output = output.map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(format!("failed: {}", output.status));
    }
    keep::text("rays", &String::from_utf8_lossy(&output.stdout), &arguments.keeping)
}

/// Writes the triangles of a scene to a file below `target`.
fn triangles_of(scene: &Path) -> Result<PathBuf, String> {
    let folder = root().join("target/bench");
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let path = folder.join("triangles.bin");
    let (from, to) = (scene.to_string_lossy(), path.to_string_lossy());
    if generate::triangles(&from, &to) { Ok(path) } else { Err(format!("{from} does not load")) }
}

/// Runs a command and waits for it.
pub(super) fn check(command: &mut Command) -> Result<(), String> {
    let status = command.status().map_err(|error| error.to_string())?;
    if status.success() { Ok(()) } else { Err(format!("failed: {status}")) }
}
