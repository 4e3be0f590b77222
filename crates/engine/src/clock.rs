//! The state that all threads of a render share: what is done, when to report, when to stop.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::render::Budget;
use crate::{Cancel, FilmSums, Observer, Progress};

/// Between two reports of progress.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

/// Counts samples, tells the observer now and then, and knows when to stop. Touched once per tile.
pub(crate) struct Clock<'a> {
    observer: &'a dyn Observer,
    cancel: &'a Cancel,
    started: Instant,
    time_limit: Option<Duration>,
    samples_total: Option<u64>,
    samples_before: u64,
    samples_done: AtomicU64,
    /// Nanoseconds after the start at which the next report is due.
    next_report: AtomicU64,
    /// Held while the observer is told, so that it hears one thing at a time.
    telling: Mutex<()>,
}

impl<'a> Clock<'a> {
    pub(crate) fn start(
        (film, budget): (&FilmSums, Budget),
        observer: &'a dyn Observer,
        cancel: &'a Cancel,
    ) -> Self {
        let per_pixel =
            budget.samples_per_pixel.map(|end| u64::from(end.saturating_sub(film.first_sample())));
        let samples_before = film.sample_count();
        Self {
            observer,
            cancel,
            started: Instant::now(),
            time_limit: budget.time,
            samples_total: per_pixel.map(|count| count.saturating_mul(film.region().pixel_count())),
            samples_before,
            samples_done: AtomicU64::new(samples_before),
            next_report: AtomicU64::new(nanoseconds(REPORT_INTERVAL)),
            telling: Mutex::new(()),
        }
    }

    /// Whether the next tile may begin. The first pass runs to its end even if time is up, so that
    /// no pixel stays empty.
    pub(crate) fn may_go_on(&self, first_pass: FirstPass) -> bool {
        let in_time =
            first_pass.0 || self.time_limit.is_none_or(|limit| self.started.elapsed() < limit);
        in_time && !self.cancel.is_cancelled()
    }

    /// Counts the samples of a finished tile, and reports if it is time to.
    pub(crate) fn count(&self, samples: u64) {
        self.samples_done.fetch_add(samples, Ordering::Relaxed);
        let now = nanoseconds(self.started.elapsed());
        if now < self.next_report.load(Ordering::Relaxed) {
            return;
        }
        // Whoever comes second finds the lock taken and goes on rendering.
        if let Ok(_telling) = self.telling.try_lock() {
            self.next_report.store(now + nanoseconds(REPORT_INTERVAL), Ordering::Relaxed);
            self.observer.progress(&self.progress());
        }
    }

    /// How far the render is.
    pub(crate) fn progress(&self) -> Progress {
        Progress {
            samples_done: self.samples_done.load(Ordering::Relaxed),
            samples_before: self.samples_before,
            samples_total: self.samples_total,
            elapsed: self.started.elapsed(),
            time_limit: self.time_limit,
        }
    }

    /// Reports the end and returns the state at it.
    pub(crate) fn finish(&self) -> Progress {
        let progress = self.progress();
        self.observer.progress(&progress);
        progress
    }
}

/// Whether the pass is the one that gives every pixel its first sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FirstPass(pub(crate) bool);

fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
