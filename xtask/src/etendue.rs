//! The `etendue` command for use by other commands: builds it and calls it.

use std::path::PathBuf;
use std::process::Command;

use crate::workspace::{cargo, root};

/// Builds the optimised command; prints errors.
pub(crate) fn build() -> bool {
    let built =
        cargo().args(["build", "--quiet", "--release", "--package", "etendue-cli"]).status();
    built.is_ok_and(|status| status.success())
}

/// The path of the optimised command.
pub(crate) fn path() -> PathBuf {
    root().join("target/release").join(format!("etendue{}", std::env::consts::EXE_SUFFIX))
}

/// The command, to be extended with arguments.
pub(crate) fn command() -> Command {
    Command::new(path())
}

/// A folder below `target` for the command's output.
///
/// # Errors
/// If it cannot be created.
pub(crate) fn folder(name: &str) -> Result<PathBuf, String> {
    let folder = root().join("target").join(name);
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    Ok(folder)
}

/// The output of a command.
///
/// # Errors
/// Its standard error, or why it cannot be started.
pub(crate) fn output(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
