//! Checks and runs the Open Job Description template with the `openjd` command.

use std::process::{Command, Stdio};

use crate::run::binary;
use crate::{SCENE, compare_with_a_single_run, empty_folder, output, root};

/// The reason why the template cannot run here, if any.
pub(crate) fn why_not() -> Option<&'static str> {
    let status = Command::new("openjd").arg("--version").stdout(Stdio::null()).status();
    status.is_err().then_some("openjd-cli is not installed")
}

/// Checks and runs the template, and compares its picture with that of a single run.
pub(crate) fn run() -> Result<(), String> {
    let folder = empty_folder("openjd")?;
    let picture = folder.join("merged.pfm");
    let template = root().join("contrib/openjd/template.yaml");
    output(Command::new("openjd").arg("check").arg(&template))?;
    let parameters = [
        format!("Scene={}", root().join(SCENE).display()),
        format!("Output={}", picture.display()),
        format!("Etendue={}", binary().display()),
        "Samples=10".to_owned(),
        "Parts=3".to_owned(),
    ];
    let mut run = Command::new("openjd");
    run.arg("run").arg(&template).args(["--step", "Merge", "--run-dependencies"]);
    for parameter in &parameters {
        run.arg("-p").arg(parameter);
    }
    output(&mut run)?;
    compare_with_a_single_run(&picture, &["--spp", "10"])
}
