//! Why a render cannot be started.

use std::fmt;

/// Why a render cannot be started.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EngineError {
    /// The film would take more memory than is allowed.
    FilmTooLarge {
        /// Width of the rendered region in pixels.
        width: u32,
        /// Height of the rendered region in pixels.
        height: u32,
        /// What the sums and the finished picture would take together.
        bytes: u64,
        /// What is allowed.
        limit: u64,
    },
    /// The region has no pixels, or lies outside the film.
    BadRegion,
    /// The budget has no samples, or neither samples nor time are limited.
    NoBudget,
    /// Films that are to be merged have other pixels or layers, or are not finished.
    OtherFilm,
    /// The operating system does not give the threads, for this reason.
    Threads(String),
}

impl fmt::Display for EngineError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FilmTooLarge { width, height, bytes, limit } => write!(
                formatter,
                "a film of {width}x{height} pixels needs {} of memory, allowed are {}",
                gigabytes(*bytes),
                gigabytes(*limit)
            ),
            Self::BadRegion => write!(formatter, "the part to render has no pixels of the film"),
            Self::NoBudget => write!(formatter, "there is neither a number of samples nor a time"),
            Self::OtherFilm => write!(
                formatter,
                "films of other pixels or layers, or with unfinished samples, cannot be merged"
            ),
            Self::Threads(reason) => write!(formatter, "threads cannot be started: {reason}"),
        }
    }
}

impl std::error::Error for EngineError {}

fn gigabytes(bytes: u64) -> String {
    format!("{:.1} GB", bytes as f64 * 1e-9)
}
