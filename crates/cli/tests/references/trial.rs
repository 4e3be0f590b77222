//! Helpers for all trials: locating files, running the command, and reporting missing files.

use std::path::{Path, PathBuf};
use std::process::Command;

use libtest_mimic::{Completion, Failed, Trial};

use crate::run::binary;

/// A slow trial that needs a folder outside the repository. It is ignored if the folder is missing.
pub(crate) fn external(
    name: String,
    folder: Option<PathBuf>,
    run: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
) -> Trial {
    let trial = Trial::ignorable_test(name, move || match folder {
        Some(folder) => run(&folder).map(|()| Completion::Completed).map_err(Failed::from),
        None => Ok(Completion::ignored_with("its files are missing")),
    });
    trial.with_ignored_flag(true)
}

/// A folder in `../shared` beside the repository, if it exists.
pub(crate) fn shared_folder(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(name);
    folder.is_dir().then_some(folder)
}

/// The path of a file that a trial writes: in `target/tmp/references`, named after the trial.
pub(crate) fn output(trial: &str, suffix: &str) -> Result<PathBuf, String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("references");
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '=');
    let name: String = trial.chars().map(|c| if is_plain(c) { c } else { '_' }).collect();
    Ok(folder.join(format!("{name}{suffix}")))
}

/// Renders a scene with variances to an EXR file.
pub(crate) fn render(scene: &Path, options: &[String], picture: &Path) -> Result<(), String> {
    let mut command = Command::new(binary());
    command.arg("render").arg(scene).args(options);
    command.args(["--variance", "--quiet", "--no-checkpoint", "--resume=never", "--output"]);
    let output = command.arg(picture).output().map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(());
    }
    Err(String::from_utf8_lossy(&output.stderr).into_owned())
}
