//! Checkpoints and parts on disk: a film's sums and what they are sums of.
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

/// Something that two films' identities do not agree in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// What it is.
    pub name: String,
    /// What the file says.
    pub file: String,
    /// What this render, or the other file, says.
    pub other: String,
}

impl SumsFile {
    /// The file at this place.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// The checkpoint of a render whose first output is `picture`: its name with `.checkpoint`.
    pub fn checkpoint_of(picture: &Path) -> Self {
        let mut name = picture.as_os_str().to_owned();
        name.push(".checkpoint");
        Self { path: name.into() }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether there is anything at its place.
    pub fn exists(&self) -> bool {
        self.path.symlink_metadata().is_ok()
    }

    /// Replaces the file with the sums as they are now. Threads may add to them meanwhile.
    ///
    /// # Errors
    ///
    /// What the operating system says; the file is then what it was.
    pub fn write(&self, film: &FilmSums, record: &FilmRecord) -> io::Result<()> {
        self.write_with(film, record, &|_| {})
    }

    /// The same, telling `reached` after every step, for tests that end the process there.
    ///
    /// # Errors
    ///
    /// As [`Self::write`].
    pub fn write_with(
        &self,
        film: &FilmSums,
        record: &FilmRecord,
        reached: &dyn Fn(WriteStep),
    ) -> io::Result<()> {
        write_durably_with(&self.path, |out: &mut dyn Write| film.write(record, out), reached)
    }

    /// Reads what the file says beside the sums. Its checksum is not looked at.
    ///
    /// # Errors
    ///
    /// [`FilmFileError`] if it cannot be read or is no such file.
    pub fn read_header(&self) -> Result<FilmFile, FilmFileError> {
        FilmFile::read_header(&mut BufReader::new(File::open(&self.path)?))
    }

    /// Reads the file; the sums may take `memory_limit` bytes.
    ///
    /// # Errors
    ///
    /// [`FilmFileError`] if it cannot be read, is torn, or there is no room.
    pub fn read(&self, memory_limit: u64) -> Result<(FilmFile, FilmSums), FilmFileError> {
        let file = File::open(&self.path)?;
        let length = file.metadata()?.len();
        let mut input = BufReader::with_capacity(1 << 20, file);
        let header = FilmFile::read_header(&mut input)?;
        let film = header.read_sums(&mut input, length, memory_limit)?;
        Ok((header, film))
    }

    /// Removes the file for good; that there is none is no error.
    ///
    /// # Errors
    ///
    /// What the operating system says.
    pub fn remove(&self) -> io::Result<()> {
        remove_durably(&self.path)
    }

    /// Removes what killed processes have left while they wrote it.
    pub fn remove_abandoned(&self) {
        remove_abandoned(&self.path);
    }
}

/// Where two identities differ: that of a file, and another.
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
