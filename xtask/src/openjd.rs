//! `cargo xtask openjd`: the template for Open Job Description, checked and run by the `openjd`
//! command, and its picture compared with that of a single run.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::etendue::{build, command, folder, output};
use crate::workspace::root;

const TEMPLATE: &str = "contrib/openjd/template.yaml";
const SCENE: &str = "scenes/cornell-box/scene.xml";

/// Whether the `openjd` command is there.
pub(crate) fn is_there() -> bool {
    Command::new("openjd").arg("--version").stdout(Stdio::null()).status().is_ok()
}

/// Checks and runs the template.
pub(crate) fn run(_arguments: &[String]) -> bool {
    if !is_there() {
        eprintln!("error: there is no `openjd` in the PATH: pip install openjd-cli");
        return false;
    }
    match build().then(check_and_run) {
        Some(Ok(())) => {
            println!("the template's picture is that of a single run, bit for bit");
            true
        }
        Some(Err(problem)) => {
            eprintln!("error: {problem}");
            false
        }
        None => false,
    }
}

fn check_and_run() -> Result<(), String> {
    let folder = folder("openjd")?;
    let picture = folder.join("merged.pfm");
    // Parts of an earlier run would not be rendered again.
    let _ = fs::remove_dir_all(folder.join("merged.pfm.parts"));
    let _ = fs::remove_file(&picture);
    let template = root().join(TEMPLATE);
    output(Command::new("openjd").arg("check").arg(&template))?;
    let parameters = [
        format!("Scene={}", root().join(SCENE).display()),
        format!("Output={}", picture.display()),
        format!("Etendue={}", Path::new(command().get_program()).display()),
        "Samples=10".to_owned(),
        "Parts=3".to_owned(),
    ];
    let mut run = Command::new("openjd");
    run.arg("run").arg(&template).args(["--step", "Merge", "--run-dependencies"]);
    for parameter in &parameters {
        run.arg("-p").arg(parameter);
    }
    output(&mut run)?;
    let whole = folder.join("whole.pfm");
    let mut render = command();
    render.arg("render").arg(root().join(SCENE)).args(["--spp", "10", "--quiet", "--resume=never"]);
    output(render.arg("--output").arg(&whole))?;
    let read = |path: &Path| fs::read(path).map_err(|error| error.to_string());
    if read(&picture)? == read(&whole)? {
        Ok(())
    } else {
        Err("the merged picture is not that of a single run".to_owned())
    }
}
