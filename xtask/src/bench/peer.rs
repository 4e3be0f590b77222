//! Installs Mitsuba 3 from PyPI into a virtual environment below the target folder and measures it.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::Measured;
use super::scenes::Scene;
use crate::workspace::root;

/// The version of published figures.
const VERSION: &str = "mitsuba==3.9.1";

/// The fastest mode on processors; it needs LLVM's shared library on the machine.
const VARIANT: &str = "llvm_ad_rgb";

/// The script that times one scene; its header describes the arguments.
const SCRIPT: &str = include_str!("mitsuba.py");

/// Installs the peer if needed; returns its Python interpreter.
pub(super) fn install() -> Result<PathBuf, String> {
    let folder = root().join("target/bench/mitsuba");
    let python = folder.join("bin/python");
    let is_there = Command::new(&python).args(["-c", "import mitsuba"]).output();
    if is_there.is_ok_and(|output| output.status.success()) {
        return Ok(python);
    }
    eprintln!("installing {VERSION} into {}", folder.display());
    check(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    check(Command::new(&python).args(["-m", "pip", "install", "--quiet", VERSION, "numpy"]))?;
    Ok(python)
}

/// The rate comes from the difference of two sample counts.
pub(super) fn measure(
    python: &Path,
    scene: &Scene,
    folder: &Path,
    threads: u32,
) -> Result<Measured, String> {
    let path = folder.join("mitsuba3").join(format!("{}.xml", scene.name));
    let mut command = Command::new(python);
    command.args(["-c", SCRIPT]).arg(path).arg(VARIANT).arg(threads.to_string());
    command.args(scene.size.iter().chain(&scene.counts).map(u32::to_string));
    let output = command.output().map_err(|error| format!("cannot run Mitsuba: {error}"))?;
    if !output.status.success() {
        return Err(format!("Mitsuba: {}", String::from_utf8_lossy(&output.stderr)));
    }
    let printed = String::from_utf8_lossy(&output.stdout);
    let figures: Vec<f64> = printed.lines().filter_map(|line| line.parse().ok()).collect();
    match *figures.as_slice() {
        [load_seconds, few, many, peak_megabytes] => {
            let rate = scene.millions_between() / (many - few);
            Ok(Measured { rate, load_seconds, peak_megabytes })
        }
        _ => Err(format!("Mitsuba printed no times: {printed}")),
    }
}

fn check(command: &mut Command) -> Result<(), String> {
    let program = command.get_program().to_string_lossy().into_owned();
    let status = command.status().map_err(|error| format!("cannot run {program}: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{program} failed")) }
}
