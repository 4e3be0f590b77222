//! The output files of one render or merge: pictures, and parts to be merged.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use etendue::durable::folder_of;
use etendue::image::losses;
use etendue::{FilmRecord, FilmSums, Rendering, SumsFile};
use rayon::prelude::*;

use crate::failure::{Failure, Status};
use crate::origin::{self, Origin};
use crate::output::{self, Target};
use crate::output_lock::OutputLock;
use crate::{terminal, text};

/// The extension of parts.
const PART_EXTENSION: &str = "part";

/// The output files, all checked to be writable.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Outputs {
    pictures: Vec<Target>,
    parts: Vec<SumsFile>,
}

/// What a render produces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Product {
    /// Pictures, and also parts if requested by name.
    Pictures,
    /// Only parts, because a subset of the samples is not a picture.
    Parts,
}

impl Outputs {
    /// Checks that files of these names can be written.
    pub(crate) fn new(paths: &[PathBuf], product: Product) -> Result<Self, Failure> {
        output::check_distinct(paths.iter().map(PathBuf::as_path))?;
        let mut outputs = Self::default();
        for path in paths {
            if is_part(path) {
                outputs.parts.push(SumsFile::new(output::probe(path)?));
            } else if product == Product::Parts {
                let path = text::path(path);
                return Err(Failure::bad_input(format!(
                    "cannot write {path}: a subset of the samples is not a picture; use the \
                     extension .{PART_EXTENSION}"
                )));
            } else {
                outputs.pictures.push(Target::new(path)?);
            }
        }
        Ok(outputs)
    }

    /// The names of all files.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &Path> {
        let pictures = self.pictures.iter().map(|target| target.path.as_path());
        pictures.chain(self.parts.iter().map(SumsFile::path))
    }

    /// The names of all files, for messages.
    pub(crate) fn names(&self) -> String {
        self.paths().map(text::path).collect::<Vec<_>>().join(", ")
    }

    /// The checkpoint that belongs to these files.
    pub(crate) fn checkpoint(&self) -> Option<SumsFile> {
        self.paths().next().map(SumsFile::checkpoint_of)
    }

    /// Locks all files against other processes.
    pub(crate) fn lock(&self) -> Result<Vec<OutputLock>, Failure> {
        let locks: Result<Vec<_>, _> = self.paths().map(OutputLock::new).collect();
        Ok(locks?.into_iter().flatten().collect())
    }

    /// Whether all files exist, with no checkpoint that marks them as unfinished.
    pub(crate) fn exist(&self) -> bool {
        let unfinished = self.checkpoint().is_some_and(|checkpoint| checkpoint.exists());
        !unfinished && self.paths().all(Path::is_file)
    }

    /// Refuses to replace files that are not of this scene, as their names were not chosen by the user.
    pub(crate) fn check_origins(&self, scene_name: &str) -> Result<(), Failure> {
        for path in self.paths().filter(|path| path.is_file()) {
            let whose = match origin::read(path) {
                Origin::Scene { name, .. } if name == scene_name => continue,
                Origin::Scene { name, .. } if name.is_empty() => "is of another scene".to_owned(),
                Origin::Scene { name, .. } => format!("is of another scene, {name}"),
                Origin::Foreign => "was not written by Etendue".to_owned(),
            };
            return Err(Failure::bad_input(format!(
                "{} exists and {whose}: choose a name with --output, or replace it with --overwrite",
                text::path(path)
            )));
        }
        Ok(())
    }

    /// Whether none of the files says that it is of another scene than the one with this hash.
    pub(crate) fn may_be_of(&self, hash: &str) -> bool {
        self.paths().all(|path| match origin::read(path) {
            Origin::Scene { hash: other, .. } => other == hash,
            Origin::Foreign => true,
        })
    }

    /// Writes the pictures in parallel, and prints an error for each that cannot be written.
    pub(crate) fn write_pictures(&self, rendering: &Rendering) -> Status {
        let write_one = |target: &Target| {
            for loss in losses(&rendering.picture, target.format, &rendering.encoding) {
                terminal::warning(&format!("{}: {loss}", text::path(&target.path)));
            }
            let encoded = rendering.encode(target.format);
            status_of(&target.path, target.write(encoded), |path| {
                let elsewhere = Target::with_format(path, Some(target.format))?;
                elsewhere.write(rendering.encode(target.format))
            })
        };
        self.pictures.par_iter().map(write_one).max().unwrap_or(Status::Success)
    }

    /// Writes the parts, and prints an error for each that cannot be written.
    pub(crate) fn write_parts(&self, film: &FilmSums, record: &FilmRecord) -> Status {
        let write_one = |part: &SumsFile| {
            let write = |part: &SumsFile| {
                let path = text::path(part.path());
                let written = part.write(film, record);
                written.map_err(|error| Failure::failed(format!("cannot write {path}: {error}")))
            };
            status_of(part.path(), write(part), |path| write(&SumsFile::new(path)))
        };
        self.parts.iter().map(write_one).max().unwrap_or(Status::Success)
    }

    pub(crate) fn has_parts(&self) -> bool {
        !self.parts.is_empty()
    }

    pub(crate) fn has_pictures(&self) -> bool {
        !self.pictures.is_empty()
    }
}

/// Reports a file that could not be written. If its folder has vanished, it is saved elsewhere, which
/// remains a failure: nobody looks for it there.
fn status_of(
    path: &Path,
    written: Result<(), Failure>,
    write_elsewhere: impl Fn(&Path) -> Result<(), Failure>,
) -> Status {
    let Err(failure) = written else { return Status::Success };
    terminal::error(&failure.message);
    if !folder_of(path).is_dir() {
        let saved = places_elsewhere(path).find(|place| write_elsewhere(place).is_ok());
        match saved {
            Some(place) => terminal::warning(&format!("saved as {} instead", text::path(&place))),
            None => terminal::error("it cannot be saved in the current or the temporary folder"),
        }
    }
    failure.status
}

/// Names that no file has, in the current folder and in the one for temporary files.
fn places_elsewhere(path: &Path) -> impl Iterator<Item = PathBuf> {
    let name = path.file_name().unwrap_or_default().to_owned();
    let folders = [std::env::current_dir().ok(), Some(std::env::temp_dir())];
    let unused = |folder: PathBuf| {
        let numbered = |number: u32| {
            let mut name = OsString::from(format!("{number}-"));
            name.push(path.file_name().unwrap_or_default());
            folder.join(name)
        };
        let plain = std::iter::once(folder.join(&name));
        plain.chain((1..100).map(numbered)).find(|place| place.symlink_metadata().is_err())
    };
    folders.into_iter().flatten().filter_map(unused).collect::<Vec<_>>().into_iter()
}

/// Whether a name is that of a part.
pub(crate) fn is_part(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(PART_EXTENSION))
}
