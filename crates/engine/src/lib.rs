//! Passes, tiles, threads, budgets, cancellation and statistics.
//!
//! [`render_samples`] spends a [`Budget`] on the pixels of a [`Region`]: it asks a
//! [`SampleSource`] for samples, pass by pass and tile by tile on the threads of [`Workers`], and
//! adds them up in [`FilmSums`]. [`Camera`] is the source that a scene is: sensor, reconstruction
//! filter, random numbers and integrator.
//!
//! A sample is a pure function of the seed and its [`SampleId`], and sums do not depend on the
//! order of what is added ([`ExactSums`]). So the picture is the same, bit for bit, for any number
//! of threads and however its samples are divided over runs, and any sample can be replayed
//! ([`Camera::replay`]).
//!
//! News leaves through [`Observer`]; [`Cancel`] stops a render and keeps what is done. A sample
//! that is infinite, not a number or negative is left out of its pixel, counted and named
//! ([`Defects`]), never turned into black.
#![forbid(unsafe_code)]

mod camera;
mod clock;
mod error;
mod exact_sums;
mod film_file;
mod film_sums;
mod observer;
mod region;
mod render;
mod schedule;
mod source;
mod splats;
mod statistics;
mod tile;
mod workers;

pub use camera::{Camera, Replay};
pub use error::EngineError;
pub use exact_sums::ExactSums;
pub use film_file::{FilmFile, FilmFileError, FilmRecord};
pub use film_sums::{Channels, FilmSums};
pub use observer::{Cancel, FinishedPass, Observer, Progress, Silent};
pub use region::Region;
pub use render::{Budget, Job, add_samples, render_samples};
pub use source::{PixelSplatSink, Sample, SampleId, SampleSource, SplatSource};
pub use splats::PixelSplat;
pub use statistics::{Defect, Defects, Statistics};
pub use workers::Workers;
