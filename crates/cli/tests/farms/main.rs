//! Runs the render farm scripts in `contrib` with the farms' own programs. Each picture must equal
//! that of a single run, bit for bit.
//!
//! The tests are slow, so they run only with `--include-ignored`. A test is also reported as
//! ignored if the farm's programs are not installed.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]

mod openjd;
#[path = "../process/run.rs"]
#[allow(dead_code, reason = "shared with the process tests, which use all of it")]
mod run;
mod slurm;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use libtest_mimic::{Arguments, Completion, Failed, Trial};

/// The scene that the farms render.
const SCENE: &str = "scenes/cornell-box/scene.xml";

fn main() -> ExitCode {
    let trials = vec![
        trial("slurm", slurm::why_not, slurm::run),
        trial("openjd", openjd::why_not, openjd::run),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn trial(
    name: &str,
    why_not: fn() -> Option<&'static str>,
    run: fn() -> Result<(), String>,
) -> Trial {
    let trial = Trial::ignorable_test(name, move || match why_not() {
        Some(reason) => Ok(Completion::ignored_with(reason)),
        None => run().map(|()| Completion::Completed).map_err(Failed::from),
    });
    trial.with_ignored_flag(true)
}

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// An empty folder below `target/tmp`. It is kept, so that the farm's logs can be read.
fn empty_folder(name: &str) -> Result<PathBuf, String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    // Otherwise the farm would skip parts of an earlier run.
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    Ok(folder)
}

/// Runs a command and returns its standard output.
///
/// # Errors
/// Its standard error, or why it cannot start.
fn output(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Compares a merged picture with that of a single run with these options.
fn compare_with_a_single_run(merged: &Path, options: &[&str]) -> Result<(), String> {
    let whole = merged.with_file_name("whole.pfm");
    let mut render = Command::new(run::binary());
    render.arg("render").arg(root().join(SCENE)).args(options);
    output(render.args(["--quiet", "--resume=never", "--output"]).arg(&whole))?;
    let read = |path: &Path| fs::read(path).map_err(|error| format!("{}: {error}", path.display()));
    if read(merged)? == read(&whole)? {
        Ok(())
    } else {
        Err("the merged picture differs from that of a single run".to_owned())
    }
}
