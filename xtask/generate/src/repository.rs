//! The files of the repository.

use std::fs;
use std::path::{Path, PathBuf};

/// The root of the repository.
pub(crate) fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// Whether the files that `cargo xtask assets` makes for a scene, and that are not committed, are
/// there, or it needs none.
pub(crate) fn has_generated_files(scene: &Path) -> bool {
    let text = fs::read_to_string(scene).unwrap_or_default();
    !text.contains("\"generated/") || scene.with_file_name("generated").is_dir()
}

/// A generated file, with its path from the root.
pub(crate) struct Made {
    pub(crate) path: &'static str,
    pub(crate) bytes: Vec<u8>,
}

impl Made {
    /// Whether the file in the repository is up to date.
    pub(crate) fn is_current(&self) -> bool {
        fs::read(root().join(self.path)).is_ok_and(|bytes| bytes == self.bytes)
    }

    /// Writes the file to its path.
    pub(crate) fn write(&self) -> Result<(), String> {
        let path = root().join(self.path);
        let message = |error: std::io::Error| format!("{}: {error}", self.path);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(message)?;
        }
        fs::write(path, &self.bytes).map_err(message)?;
        println!("{:>8} bytes  {}", self.bytes.len(), self.path);
        Ok(())
    }
}

/// Whether files are written or compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    Write,
    Check,
}

impl Mode {
    /// The mode that `--check` selects.
    pub(crate) fn from_check(check: bool) -> Self {
        if check { Self::Check } else { Self::Write }
    }
}

/// Writes the files, or fails and names those that are out of date.
pub(crate) fn write_or_check(files: &[Made], mode: Mode) -> Result<(), String> {
    if mode == Mode::Write {
        return files.iter().try_for_each(Made::write);
    }
    let stale: Vec<&str> =
        files.iter().filter(|file| !file.is_current()).map(|file| file.path).collect();
    if stale.is_empty() {
        return Ok(());
    }
    Err(format!("not current, run this again without --check: {}", stale.join(", ")))
}
