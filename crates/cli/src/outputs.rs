//! The files that one render or merge is to make: pictures, and parts to be merged.

use std::path::{Path, PathBuf};

use etendue::{FilmRecord, FilmSums, Rendering, SumsFile};
use rayon::prelude::*;

use crate::failure::{Failure, Status};
use crate::output::{self, Target};
use crate::terminal;

/// The extension of parts.
const PART_EXTENSION: &str = "part";

/// The files to be made, all checked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Outputs {
    pictures: Vec<Target>,
    parts: Vec<SumsFile>,
}

/// What a render makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Product {
    /// Pictures, and parts where they are named.
    Pictures,
    /// A range of samples, which is no picture: parts alone.
    Parts,
}

impl Outputs {
    /// Files of these names, in folders where files can be made.
    pub(crate) fn new(paths: &[PathBuf], product: Product) -> Result<Self, Failure> {
        let mut outputs = Self::default();
        for path in paths {
            if is_part(path) {
                output::probe(path)?;
                outputs.parts.push(SumsFile::new(path));
            } else if product == Product::Parts {
                let path = path.display();
                return Err(Failure::bad_input(format!(
                    "cannot write {path}: some of the samples make a part of a picture; name it \
                     with .{PART_EXTENSION}"
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

    /// Where the samples are kept until the files are there.
    pub(crate) fn checkpoint(&self) -> Option<SumsFile> {
        self.paths().next().map(SumsFile::checkpoint_of)
    }

    /// Whether all files are there and nothing says that they are unfinished.
    pub(crate) fn exist(&self) -> bool {
        let unfinished = self.checkpoint().is_some_and(|checkpoint| checkpoint.exists());
        !unfinished && self.paths().all(Path::is_file)
    }

    /// Writes every picture that can be written, several at once, and tells why of the others.
    pub(crate) fn write_pictures(&self, rendering: &Rendering) -> Status {
        let write_one = |target: &Target| status_of(target.write(rendering.encode(target.format)));
        self.pictures.par_iter().map(write_one).max().unwrap_or(Status::Fine)
    }

    /// Writes every part that can be written, and tells why of the others.
    pub(crate) fn write_parts(&self, film: &FilmSums, record: &FilmRecord) -> Status {
        let write_one = |part: &SumsFile| {
            let path = part.path().display();
            let written = part.write(film, record);
            status_of(
                written.map_err(|error| Failure::failed(format!("cannot write {path}: {error}"))),
            )
        };
        self.parts.iter().map(write_one).max().unwrap_or(Status::Fine)
    }

    /// Whether there are parts among the files.
    pub(crate) fn has_parts(&self) -> bool {
        !self.parts.is_empty()
    }

    /// Whether there are pictures among the files.
    pub(crate) fn has_pictures(&self) -> bool {
        !self.pictures.is_empty()
    }
}

fn status_of(written: Result<(), Failure>) -> Status {
    match written {
        Ok(()) => Status::Fine,
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
