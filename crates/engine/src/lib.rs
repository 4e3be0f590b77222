//! Passes, tiles, threads, budgets, cancellation and statistics.
//!
//! [`render`](fn@render) spends a [`Budget`] on the pixels of a [`Region`]. It asks a [`SampleSource`] for
//! samples, pass by pass and tile by tile on the threads of [`Workers`], and adds them up in
//! [`FilmSums`]. [`render_into`] does so with a film that may hold samples of earlier runs. A
//! [`Camera`] is the source that a scene is: sensor, reconstruction filter, random numbers and
//! integrator. Some integrators are trained first ([`Camera::train`]).
//!
//! A sample is a pure function of the seed and its [`SampleId`], and the order of samples does not
//! change a sum ([`ExactSums`]). So the picture is the same, bit for bit, for any number of threads
//! and any division of its samples over runs, and any sample can be replayed ([`Camera::replay`]).
//!
//! An [`Observer`] hears how the render goes; [`Cancel`] stops it and keeps what is done. A sample
//! that is infinite, not a number or negative is left out of its pixel, counted and named
//! ([`Defects`]). It never turns into black.
#![forbid(unsafe_code)]

mod camera;
mod clock;
mod error;
mod exact_sums;
mod film_file;
mod film_sums;
mod host;
mod job;
mod nearest;
mod observer;
mod region;
mod render;
mod schedule;
mod source;
mod splats;
mod statistics;
mod tile;
mod training;
mod variance;
mod workers;

pub use camera::{Camera, Replay};
pub use error::EngineError;
pub use etendue_integrators::{ChannelKind, Watch};
pub use exact_sums::ExactSums;
pub use film_file::{FilmFile, FilmFileError, FilmRecord};
pub use film_sums::{Channels, FilmSums};
pub use host::Host;
pub use job::{Budget, Job};
pub use observer::{Cancel, FinishedPass, Observer, Progress, Silent};
pub use region::Region;
pub use render::{render, render_into};
pub use source::{PixelSplatSink, Sample, SampleId, SampleSource, SplatSource};
pub use splats::PixelSplat;
pub use statistics::{Defect, DefectiveSample, Defects, SamplesPerPixel, Statistics};
pub use workers::Workers;
