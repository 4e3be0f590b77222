//! Installs Embree from the wheel `embreex` of PyPI below the target folder.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::workspace::root;

/// The version of published figures.
const VERSION: &str = "embreex==4.4.0";

/// Installs the library if needed; returns its path. The thread library it needs lies next to it.
pub(super) fn install() -> Result<PathBuf, String> {
    let folder = root().join("target/bench/embree");
    if let Some(library) = find(&folder) {
        return Ok(library);
    }
    eprintln!("fetching {VERSION} into {}", folder.display());
    let mut pip = Command::new("python3");
    pip.args(["-m", "pip", "install", "--quiet", "--no-deps", "--target"]).arg(&folder);
    let status = pip.arg(VERSION).status().map_err(|error| format!("cannot run pip: {error}"))?;
    if !status.success() {
        return Err(format!("pip does not install {VERSION}"));
    }
    find(&folder).ok_or_else(|| format!("{VERSION} has no library"))
}

fn find(folder: &Path) -> Option<PathBuf> {
    let files = std::fs::read_dir(folder.join("embreex.libs")).ok()?;
    let mut paths = files.filter_map(|file| Some(file.ok()?.path()));
    paths
        .find(|path| path.file_name().is_some_and(|name| name.to_string_lossy().contains("embree")))
}
