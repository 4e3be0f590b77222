//! The output files of one render or merge: pictures, and parts to be merged.

use std::path::{Path, PathBuf};

use etendue::image::losses;
use etendue::{FilmRecord, FilmSums, Rendering, SumsFile};
use rayon::prelude::*;

use crate::failure::{Failure, Status};
use crate::origin::{self, Origin};
use crate::output::{self, Target};
use crate::terminal;

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
                let path = path.display();
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
        self.paths().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
    }

    /// The checkpoint that belongs to these files.
    pub(crate) fn checkpoint(&self) -> Option<SumsFile> {
        self.paths().next().map(SumsFile::checkpoint_of)
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
                path.display()
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
                terminal::warning(&format!("{}: {loss}", target.path.display()));
            }
            status_of(target.write(rendering.encode(target.format)))
        };
        self.pictures.par_iter().map(write_one).max().unwrap_or(Status::Success)
    }

    /// Writes the parts, and prints an error for each that cannot be written.
    pub(crate) fn write_parts(&self, film: &FilmSums, record: &FilmRecord) -> Status {
        let write_one = |part: &SumsFile| {
            let path = part.path().display();
            let written = part.write(film, record);
            status_of(
                written.map_err(|error| Failure::failed(format!("cannot write {path}: {error}"))),
            )
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

fn status_of(written: Result<(), Failure>) -> Status {
    match written {
        Ok(()) => Status::Success,
        Err(failure) => {
            terminal::error(&failure.message);
            failure.status
        }
    }
}

/// Whether a name is that of a part.
pub(crate) fn is_part(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(PART_EXTENSION))
}
