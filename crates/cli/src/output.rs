//! Files that are written: named and checked before the work begins, whole or not at all.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use etendue::image::{FileFormat, ImageError};

use crate::failure::Failure;

/// A picture file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub(crate) path: PathBuf,
    pub(crate) format: FileFormat,
}

impl Target {
    /// A target whose format is that of its extension, in a folder where a file can be made.
    pub(crate) fn new(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let Some(format) = extension.and_then(FileFormat::from_extension) else {
            let known: Vec<_> =
                FileFormat::all().filter_map(|f| f.extensions().first().copied()).collect();
            let problem = match extension {
                Some(extension) => format!("`.{extension}` is no picture format"),
                None => "there is no extension to tell the format by".to_owned(),
            };
            let (path, known) = (path.display(), known.join(", "));
            return Err(Failure::bad_input(format!(
                "cannot write {path}: {problem}; there are {known}"
            )));
        };
        let target = Self { path: path.to_path_buf(), format };
        target.probe().map_err(|reason| target.failure(&reason))?;
        Ok(target)
    }

    /// Finds out whether the file could be written, by making a temporary one.
    fn probe(&self) -> Result<(), String> {
        if self.path.is_dir() {
            return Err("it is a folder".to_owned());
        }
        let folder = folder_of(&self.path);
        if !folder.is_dir() {
            return Err(format!("there is no folder {}", folder.display()));
        }
        let temporary = temporary_name(&self.path);
        let made = fs::File::create_new(&temporary);
        made.and_then(|_| fs::remove_file(&temporary)).map_err(|error| error.to_string())
    }

    fn failure(&self, reason: &str) -> Failure {
        Failure::bad_input(format!("cannot write {}: {reason}", self.path.display()))
    }

    /// Puts an encoded picture in place.
    pub(crate) fn write(&self, encoded: Result<Vec<u8>, ImageError>) -> Result<(), Failure> {
        let result = match encoded {
            Ok(bytes) => write_whole(&self.path, &bytes).map_err(|error| error.to_string()),
            Err(error) => Err(error.to_string()),
        };
        let path = self.path.display();
        result.map_err(|reason| Failure::failed(format!("cannot write {path}: {reason}")))
    }
}

/// The outputs of a scene for which none were named: its own name with `.exr` and with `.png`.
pub(crate) fn default_names(scene: &Path, folder: &Path) -> [PathBuf; 2] {
    let stem = scene.file_stem().unwrap_or_else(|| "picture".as_ref());
    // A stem may hold dots, so the extension is added rather than set.
    ["exr", "png"].map(|extension| {
        let mut name = stem.to_owned();
        name.push(".");
        name.push(extension);
        folder.join(name)
    })
}

/// Writes a file under a temporary name beside its target and renames it, so that the target is at
/// every moment either what it was or complete.
fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let temporary = temporary_name(path);
    let written = fs::File::create_new(&temporary)
        .and_then(|mut file| file.write_all(bytes))
        .and_then(|()| fs::rename(&temporary, path));
    if written.is_err() {
        // The first error is the one to report.
        let _ = fs::remove_file(&temporary);
    }
    written
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// A hidden name in the target's folder that no other process uses.
fn temporary_name(path: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.tmp", std::process::id()));
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_names_are_the_scenes() {
        let names = default_names(Path::new("a/b/scene.v2.xml"), Path::new("out"));
        assert_eq!(names, [PathBuf::from("out/scene.v2.exr"), PathBuf::from("out/scene.v2.png")]);
    }

    #[test]
    fn temporary_names_lie_beside_their_targets() {
        let name = temporary_name(Path::new("folder/a.exr"));
        assert_eq!(name.parent(), Some(Path::new("folder")));
        assert_ne!(name.extension(), Some("exr".as_ref()));
        assert_eq!(temporary_name(Path::new("a.exr")).parent(), Some(Path::new("")));
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let occupied = folder.path().join("occupied");
        fs::create_dir(&occupied).unwrap();
        fs::write(occupied.join("inside"), "x").unwrap();
        assert!(write_whole(&occupied, b"new").is_err(), "a folder cannot be replaced by a file");
        let names: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(names.len(), 1);
    }
}
