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
        /// The bytes that the film and the finished picture would take together.
        bytes: u64,
        /// The bytes that they may take.
        limit: u64,
    },
    /// The region has no pixels, or lies outside the film.
    BadRegion,
    /// The budget has no samples, or limits neither samples nor time.
    NoBudget,
    /// The films to merge have different pixels or channels, or unfinished samples.
    OtherFilm,
    /// It was cancelled before the integrator was trained.
    Cancelled,
    /// The operating system refuses to start the threads, for this reason.
    Threads(String),
}

impl fmt::Display for EngineError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FilmTooLarge { width, height, bytes, limit } => write!(
                formatter,
                "a film of {width}x{height} pixels needs {} of memory; the limit is {}",
                gigabytes(*bytes),
                gigabytes(*limit)
            ),
            Self::BadRegion => {
                write!(formatter, "the region to render has no pixels, or lies outside the film")
            }
            Self::NoBudget => write!(
                formatter,
                "neither the number of samples nor the time is limited, or there are no samples"
            ),
            Self::OtherFilm => write!(
                formatter,
                "films of different pixels or layers, or with unfinished samples, cannot be merged"
            ),
            Self::Cancelled => write!(formatter, "cancelled during training"),
            Self::Threads(reason) => write!(formatter, "threads cannot be started: {reason}"),
        }
    }
}

impl std::error::Error for EngineError {}

fn gigabytes(bytes: u64) -> String {
    format!("{:.1} GB", bytes as f64 * 1e-9)
}
