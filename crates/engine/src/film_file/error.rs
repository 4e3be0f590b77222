//! Why a film's file cannot be read.

use std::{fmt, io};

use crate::EngineError;

/// Why a film's file cannot be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum FilmFileError {
    /// The operating system does not give the bytes.
    Io(io::Error),
    /// The file is of another kind.
    NotSums,
    /// The file is of another version of the format.
    Version(u32),
    /// The file ends early, or its checksum is not that of its bytes.
    Torn,
    /// The checksum is right, but the content makes no sense, for this reason.
    Invalid(&'static str),
    /// There is no room for the sums.
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
            Self::NotSums => write!(formatter, "this is no checkpoint or part of a picture"),
            Self::Version(version) => write!(
                formatter,
                "the file is of version {version} of the format; this program reads version {}",
                super::VERSION
            ),
            Self::Torn => write!(formatter, "the file is torn: its checksum is not right"),
            Self::Invalid(what) => write!(formatter, "the file makes no sense: {what}"),
            Self::Engine(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for FilmFileError {}
