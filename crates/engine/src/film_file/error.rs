//! Why a film's file cannot be read.

use std::{fmt, io};

use super::format::VERSION;
use crate::error::EngineError;

/// Why a film's file cannot be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum FilmFileError {
    /// Reading failed.
    Io(io::Error),
    /// This is not a regular file, but a folder, a pipe or a device.
    NotAFile,
    /// The file is not a film's.
    NotSums,
    /// The file has another version of the format.
    Version(u32),
    /// The file ends early, or its checksum is wrong.
    Torn,
    /// The content is invalid, for this reason.
    Invalid(&'static str),
    /// The film cannot be created.
    Engine(EngineError),
}

impl From<io::Error> for FilmFileError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self::Torn,
            _ => Self::Io(error),
        }
    }
}

impl fmt::Display for FilmFileError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(formatter),
            Self::NotAFile => write!(formatter, "this is not a regular file"),
            Self::NotSums => write!(formatter, "this is not a checkpoint or a part of a picture"),
            Self::Version(version) => write!(
                formatter,
                "the file has version {version} of the format; this program reads version {}",
                VERSION
            ),
            Self::Torn => write!(formatter, "the file is torn: its checksum is wrong"),
            Self::Invalid(what) => write!(formatter, "the file is invalid: {what}"),
            Self::Engine(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for FilmFileError {}
