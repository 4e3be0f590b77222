//! The test scenes: where they are, and how the `etendue` command renders them.

#[path = "../../../crates/cli/tests/references/cases.rs"]
pub(crate) mod cases;

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::repository::root;

/// The folder of the test scenes.
pub(crate) fn folder() -> PathBuf {
    root().join("crates/cli/tests/references/scenes")
}

/// Builds the optimised `etendue` command of this checkout and returns its path.
///
/// # Errors
/// If it does not compile.
pub(crate) fn build() -> Result<PathBuf, String> {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut cargo = Command::new(program);
    cargo.current_dir(root()).args(["build", "--quiet", "--release", "--package", "etendue-cli"]);
    match cargo.status() {
        Ok(status) if status.success() => {
            let name = format!("etendue{}", std::env::consts::EXE_SUFFIX);
            Ok(root().join("target/release").join(name))
        }
        Ok(_) => Err("etendue does not compile".to_owned()),
        Err(error) => Err(format!("cannot start cargo: {error}")),
    }
}

/// A render command without a checkpoint, to be extended with options.
pub(crate) fn render(binary: &Path, scene: &Path, options: &[String]) -> Command {
    let mut command = Command::new(binary);
    command.arg("render").arg(scene).args(options);
    command.args(["--quiet", "--no-checkpoint", "--resume=never"]);
    command
}

/// Runs a command; its standard error becomes the error message.
///
/// # Errors
/// If it cannot start or fails.
pub(crate) fn succeed(command: &mut Command) -> Result<(), String> {
    let output = command.output();
    let output = output.map_err(|error| format!("{:?}: {error}", command.get_program()))?;
    if output.status.success() {
        return Ok(());
    }
    Err(String::from_utf8_lossy(&output.stderr).into_owned())
}
