//! Writes checkpoints and previews while a render runs.

use std::path::PathBuf;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use etendue::{FilmSums, RenderJob, Statistics, SumsFile};

use crate::failure::Failure;
use crate::output::Target;
use crate::parsers;
use crate::progress::ProgressDisplay;
use crate::text;

/// The options for checkpoints and previews.
#[derive(Args, Debug)]
pub(crate) struct CheckpointArguments {
    /// Resume from the checkpoint beside the output. yes: require one; auto: resume if one exists;
    /// never: start over. Without this option, etendue asks about an existing checkpoint on a
    /// terminal, and fails elsewhere
    #[arg(long, value_name = "WHEN", num_args = 0..=1, require_equals = true,
          default_missing_value = "yes")]
    pub(crate) resume: Option<Resume>,
    /// How often to write a checkpoint, as FILE.checkpoint beside the first output
    #[arg(long, value_name = "TIME", value_parser = parsers::interval, default_value = "30s")]
    checkpoint_every: Duration,
    /// Write no checkpoints
    #[arg(long)]
    pub(crate) no_checkpoint: bool,
    /// Keep the checkpoint when the render is done, to add samples later with a higher --spp
    #[arg(long, conflicts_with = "no_checkpoint")]
    pub(crate) keep_checkpoint: bool,
    /// Write previews of the unfinished picture to this file
    #[arg(long, value_name = "FILE")]
    preview: Option<PathBuf>,
    /// How often to write the preview
    #[arg(long, value_name = "TIME", value_parser = parsers::interval, default_value = "10s")]
    preview_every: Duration,
}

/// What to do about an existing checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Resume {
    /// Resume; fail if there is no checkpoint
    Yes,
    /// Resume if a checkpoint exists; otherwise start
    Auto,
    /// Start over and overwrite the checkpoint
    Never,
}

impl CheckpointArguments {
    /// The preview's target, checked for being writable.
    pub(crate) fn preview(&self) -> Result<Option<Target>, Failure> {
        self.preview.as_deref().map(Target::new).transpose()
    }
}

/// Writes checkpoints and previews while other threads render.
pub(crate) struct CheckpointWriter<'a> {
    pub(crate) job: &'a RenderJob,
    pub(crate) film: &'a FilmSums,
    /// `None` to write none.
    pub(crate) checkpoint: Option<&'a SumsFile>,
    pub(crate) preview: Option<&'a Target>,
    pub(crate) arguments: &'a CheckpointArguments,
    pub(crate) display: &'a ProgressDisplay,
    /// Wall time of the earlier runs, in seconds.
    pub(crate) seconds_before: f64,
    pub(crate) started: Instant,
}

/// Tells a [`CheckpointWriter`] that the render has ended.
#[derive(Default)]
pub(crate) struct End {
    has_come: Mutex<bool>,
    changed: Condvar,
}

/// Signals the end when dropped, even during a panic; otherwise the writer would wait forever.
pub(crate) struct EndGuard<'a>(&'a End);

impl Drop for EndGuard<'_> {
    fn drop(&mut self) {
        *self.0.lock() = true;
        self.0.changed.notify_all();
    }
}

impl End {
    /// Returns a guard that signals the end when dropped.
    pub(crate) fn guard(&self) -> EndGuard<'_> {
        EndGuard(self)
    }

    /// Waits until `time` or the end, whichever comes first; returns whether the end has come.
    fn wait_until(&self, time: Instant) -> bool {
        let mut has_come = self.lock();
        while !*has_come {
            let Some(left) = time.checked_duration_since(Instant::now()).filter(|t| !t.is_zero())
            else {
                return false;
            };
            let waited = self.changed.wait_timeout(has_come, left);
            has_come = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        true
    }

    fn lock(&self) -> MutexGuard<'_, bool> {
        self.has_come.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl CheckpointWriter<'_> {
    /// Writes checkpoints and previews as they fall due, until the end.
    pub(crate) fn run(&self, end: &End) {
        let every = self.arguments.checkpoint_every;
        let mut next_checkpoint = self.checkpoint.map(|_| self.started + every);
        let mut next_preview = self.preview.map(|_| self.started + self.arguments.preview_every);
        while let Some(next) = [next_checkpoint, next_preview].into_iter().flatten().min() {
            if end.wait_until(next) {
                return;
            }
            let now = Instant::now();
            // The interval runs from the start of one write to the start of the next, so a crash
            // loses at most one interval and the duration of a write.
            if next_checkpoint.is_some_and(|due| due <= now) {
                next_checkpoint = Some(now + every);
                self.write_checkpoint();
            }
            if next_preview.is_some_and(|due| due <= now) {
                next_preview = Some(now + self.arguments.preview_every);
                self.write_preview();
            }
        }
    }

    /// Writes a checkpoint; on failure, warns and lets the render continue. Returns whether it was
    /// written.
    pub(crate) fn write_checkpoint(&self) -> bool {
        let Some(checkpoint) = self.checkpoint else { return false };
        let began = Instant::now();
        let written = checkpoint.write(self.film, &self.job.record(self.seconds()));
        let path = text::path(checkpoint.path());
        match &written {
            Ok(()) => self.display.checkpoint(checkpoint.path(), began.elapsed()),
            Err(error) => {
                let previous =
                    if checkpoint.exists() { "; the previous checkpoint remains" } else { "" };
                self.display.warn(&format!("cannot write {path}: {error}{previous}"));
            }
        }
        written.is_ok()
    }

    fn write_preview(&self) {
        let Some(target) = self.preview else { return };
        let samples_per_pixel = self.film.samples_per_pixel();
        if samples_per_pixel.most == 0 {
            return;
        }
        let statistics = Statistics { samples_per_pixel, ..Statistics::default() };
        let rendering = self.job.develop(self.film, statistics, self.seconds());
        if let Err(failure) = target.write(rendering.encode(target.format)) {
            self.display.warn(&failure.message);
        }
    }

    /// Wall time of all runs, in seconds.
    pub(crate) fn seconds(&self) -> f64 {
        self.seconds_before + self.started.elapsed().as_secs_f64()
    }
}
