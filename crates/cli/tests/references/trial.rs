//! What all trials share: where their files are, how the command is run, and how they are told.

use std::path::{Path, PathBuf};
use std::process::Command;

use libtest_mimic::{Completion, Failed, Trial};

use crate::run::binary;

/// A slow trial that needs a folder from outside the repository: ignored where it is missing.
pub(crate) fn external(
    name: String,
    folder: PathBuf,
    run: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
) -> Trial {
    let trial = Trial::ignorable_test(name, move || {
        if !folder.is_dir() {
            return Ok(Completion::ignored_with(format!("there is no {}", folder.display())));
        }
        run(&folder).map(|()| Completion::Completed).map_err(Failed::from)
    });
    trial.with_ignored_flag(true)
}

/// A folder of `shared`, which is beside the repository or where `ETENDUE_SHARED` says.
pub(crate) fn shared_folder(name: &str) -> PathBuf {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    std::env::var_os("ETENDUE_SHARED").map_or_else(beside, PathBuf::from).join(name)
}

/// A place for a file that a trial writes: below `target/tmp/references`, named after the trial.
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
