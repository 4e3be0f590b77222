//! Keeping what is done: checkpoints and previews, written beside the render.

use std::path::PathBuf;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use etendue::{FilmSums, RenderJob, Statistics, SumsFile};

use crate::failure::Failure;
use crate::output::Target;
use crate::parsers;
use crate::progress::ProgressDisplay;

/// How what is done is kept, shown and found again.
#[derive(Args, Debug)]
pub(crate) struct CheckpointArguments {
    /// Go on with the checkpoint beside the output. yes: there must be one; auto: if there is one;
    /// never: start afresh. Without this option, a checkpoint is asked about on a terminal, and
    /// elsewhere nothing is done
    #[arg(long, value_name = "WHEN", num_args = 0..=1, require_equals = true,
          default_missing_value = "yes")]
    pub(crate) resume: Option<Resume>,
    /// How often what is done is kept, in FILE.checkpoint beside the first output
    #[arg(long, value_name = "TIME", value_parser = parsers::interval, default_value = "30s")]
    checkpoint_every: Duration,
    /// Keep no checkpoints
    #[arg(long)]
    pub(crate) no_checkpoint: bool,
    /// Leave the checkpoint when the render is done, to go on later with more --spp
    #[arg(long, conflicts_with = "no_checkpoint")]
    pub(crate) keep_checkpoint: bool,
    /// Write the picture so far here, as often as --preview-every says
    #[arg(long, value_name = "FILE")]
    preview: Option<PathBuf>,
    /// How often the preview is written
    #[arg(long, value_name = "TIME", value_parser = parsers::interval, default_value = "10s")]
    preview_every: Duration,
}

/// What is done about a checkpoint that is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Resume {
    /// Go on with it; without one, do nothing
    Yes,
    /// Go on with it; without one, start
    Auto,
    /// Start afresh; it is overwritten
    Never,
}

impl CheckpointArguments {
    /// The preview's file, checked.
    pub(crate) fn preview(&self) -> Result<Option<Target>, Failure> {
        self.preview.as_deref().map(Target::new).transpose()
    }
}

/// Writes checkpoints and previews while others render.
pub(crate) struct CheckpointWriter<'a> {
    pub(crate) job: &'a RenderJob,
    pub(crate) film: &'a FilmSums,
    /// `None` if none are kept.
    pub(crate) checkpoint: Option<&'a SumsFile>,
    pub(crate) preview: Option<&'a Target>,
    pub(crate) arguments: &'a CheckpointArguments,
    pub(crate) display: &'a ProgressDisplay,
    /// Wall time of the runs before.
    pub(crate) seconds_before: f64,
    pub(crate) started: Instant,
}

/// Tells a checkpoint writer that the render is over.
#[derive(Default)]
pub(crate) struct End {
    has_come: Mutex<bool>,
    changed: Condvar,
}

/// Signals the end when it is dropped, also after a panic: the writer must not wait for ever.
pub(crate) struct EndGuard<'a>(&'a End);

impl Drop for EndGuard<'_> {
    fn drop(&mut self) {
        *self.0.lock() = true;
        self.0.changed.notify_all();
    }
}

impl End {
    /// The end comes when the guard goes.
    pub(crate) fn guard(&self) -> EndGuard<'_> {
        EndGuard(self)
    }

    /// Waits until some time, or for the end; returns whether that has come.
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
    /// Writes what is due, again and again, until the end has come.
    pub(crate) fn run(&self, end: &End) {
        let every = self.arguments.checkpoint_every;
        let mut next_checkpoint = self.checkpoint.map(|_| self.started + every);
        let mut next_preview = self.preview.map(|_| self.started + self.arguments.preview_every);
        while let Some(next) = [next_checkpoint, next_preview].into_iter().flatten().min() {
            if end.wait_until(next) {
                return;
            }
            let now = Instant::now();
            // From the beginning of one to that of the next: at most an interval is lost, and the
            // time that the last one took.
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

    /// Keeps what is done; that it fails is said, and the render goes on. Returns whether it is
    /// kept.
    pub(crate) fn write_checkpoint(&self) -> bool {
        let Some(checkpoint) = self.checkpoint else { return false };
        let began = Instant::now();
        let written = checkpoint.write(self.film, &self.job.record(self.seconds()));
        let path = checkpoint.path().display();
        match &written {
            Ok(()) => self.display.checkpoint(checkpoint.path(), began.elapsed()),
            Err(error) => {
                let kept = if checkpoint.exists() { "; the last one stays" } else { "" };
                self.display.warn(&format!("cannot write {path}: {error}{kept}"));
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

    /// Wall time of all runs.
    pub(crate) fn seconds(&self) -> f64 {
        self.seconds_before + self.started.elapsed().as_secs_f64()
    }
}
