//! Checkpoints and parts on disk: a film's sums and their identity.
#![allow(
    clippy::disallowed_methods,
    reason = "hosts choose this module when they want files to be read and written"
)]

use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::{Path, PathBuf};

use etendue_engine::{FilmFile, FilmFileError, FilmRecord, FilmSums};

use crate::durable::{WriteStep, remove_abandoned, remove_durably, write_durably_with};

/// A checkpoint of a render, or a part of a picture, on disk.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SumsFile {
    path: PathBuf,
}

/// A difference between the identities of two films.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The name of the property.
    pub name: String,
    /// Its value in the file.
    pub file: String,
    /// Its value in this render, or in the other file.
    pub other: String,
}

impl SumsFile {
    /// The file at this path.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// The checkpoint of a render whose first output is `picture`: that name plus `.checkpoint`.
    pub fn checkpoint_of(picture: &Path) -> Self {
        let mut name = picture.as_os_str().to_owned();
        name.push(".checkpoint");
        Self { path: name.into() }
    }

    /// The path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the file exists.
    pub fn exists(&self) -> bool {
        self.path.symlink_metadata().is_ok()
    }

    /// Replaces the file with the current sums. Other threads may add samples meanwhile.
    ///
    /// # Errors
    ///
    /// Returns the operating system's error; the file is then unchanged.
    pub fn write(&self, film: &FilmSums, record: &FilmRecord) -> io::Result<()> {
        self.write_with(film, record, &|_| {})
    }

    /// Like [`Self::write`], but calls `reached` after every step, so that tests can end the
    /// process there.
    ///
    /// # Errors
    ///
    /// Same as [`Self::write`].
    pub fn write_with(
        &self,
        film: &FilmSums,
        record: &FilmRecord,
        reached: &dyn Fn(WriteStep),
    ) -> io::Result<()> {
        write_durably_with(&self.path, |out: &mut dyn Write| film.write(record, out), reached)
    }

    /// Reads the header of the file. Its checksum is not verified.
    ///
    /// # Errors
    ///
    /// [`FilmFileError`] if it cannot be read or is not a sums file.
    pub fn read_header(&self) -> Result<FilmFile, FilmFileError> {
        FilmFile::read_header(&mut BufReader::new(self.open()?))
    }

    /// Reads the file; the sums may take up to `memory_limit` bytes.
    ///
    /// # Errors
    ///
    /// [`FilmFileError`] if it cannot be read, is incomplete, or exceeds the memory limit.
    pub fn read(&self, memory_limit: u64) -> Result<(FilmFile, FilmSums), FilmFileError> {
        let file = self.open()?;
        let length = file.metadata()?.len();
        let mut input = BufReader::with_capacity(1 << 20, file);
        let header = FilmFile::read_header(&mut input)?;
        let film = header.read_sums(&mut input, length, memory_limit)?;
        Ok((header, film))
    }

    /// Opens the file if it is a regular one. Opening a pipe would wait for somebody to write to it.
    fn open(&self) -> Result<File, FilmFileError> {
        if std::fs::metadata(&self.path)?.is_file() {
            Ok(File::open(&self.path)?)
        } else {
            Err(FilmFileError::NotAFile)
        }
    }

    /// Deletes the file durably; a missing file is not an error.
    ///
    /// # Errors
    ///
    /// Returns the operating system's error.
    pub fn remove(&self) -> io::Result<()> {
        remove_durably(&self.path)
    }

    /// Deletes temporary files left by processes killed while writing it.
    pub fn remove_abandoned(&self) {
        remove_abandoned(&self.path);
    }
}

/// The differences between a file's identity and another one.
pub fn differences(file: &[(String, String)], other: &[(String, String)]) -> Vec<Difference> {
    let value = |entries: &[(String, String)], name: &str| {
        let found = entries.iter().find(|(other, _)| other == name);
        found.map_or_else(|| "nothing".to_owned(), |(_, value)| value.clone())
    };
    let mut names: Vec<&String> = file.iter().map(|(name, _)| name).collect();
    names.extend(
        other
            .iter()
            .map(|(name, _)| name)
            .filter(|name| !file.iter().any(|(known, _)| known == *name)),
    );
    let compared = names.into_iter().map(|name| Difference {
        name: name.clone(),
        file: value(file, name),
        other: value(other, name),
    });
    compared.filter(|difference| difference.file != difference.other).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_has_the_pictures_name() {
        let checkpoint = SumsFile::checkpoint_of(Path::new("out/a.exr"));
        assert_eq!(checkpoint.path(), Path::new("out/a.exr.checkpoint"));
    }

    #[test]
    fn differences_are_named_from_both_sides() {
        let pairs = |pairs: &[(&str, &str)]| -> Vec<(String, String)> {
            pairs.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
        };
        let file = pairs(&[("seed", "1"), ("scene", "x"), ("old", "y")]);
        let own = pairs(&[("scene", "x"), ("seed", "2"), ("new", "z")]);
        let found = differences(&file, &own);
        let names: Vec<&str> = found.iter().map(|found| found.name.as_str()).collect();
        assert_eq!(names, ["seed", "old", "new"]);
        assert_eq!((found[0].file.as_str(), found[0].other.as_str()), ("1", "2"));
        assert_eq!(found[1].other, "nothing");
        assert!(differences(&file, &file).is_empty());
    }
}
