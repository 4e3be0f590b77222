//! What all threads of a render share: how much is done, when to report, when to stop.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::film_sums::FilmSums;
use crate::job::Budget;
use crate::observer::{Cancel, Observer, Progress};

/// The time between two reports of progress.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

/// Counts samples, reports to the observer from time to time, and knows when to stop. It is used
/// once per tile.
pub(crate) struct Clock<'a> {
    observer: &'a dyn Observer,
    cancel: &'a Cancel,
    started: Instant,
    time_limit: Option<Duration>,
    samples_total: Option<u64>,
    samples_before: u64,
    samples_done: AtomicU64,
    /// Paths of these samples that reached a limit of their length.
    truncated_paths: AtomicU64,
    /// Nanoseconds after the start at which the next report is due.
    next_report: AtomicU64,
    /// Held during a report, so that the observer hears one at a time.
    reporting: Mutex<()>,
}

impl<'a> Clock<'a> {
    pub(crate) fn start(
        film: &FilmSums,
        budget: Budget,
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
            truncated_paths: AtomicU64::new(0),
            next_report: AtomicU64::new(nanoseconds(REPORT_INTERVAL)),
            reporting: Mutex::new(()),
        }
    }

    /// Whether there is time left and nobody has cancelled.
    pub(crate) fn may_go_on(&self) -> bool {
        self.is_in_time() && !self.cancel.is_cancelled()
    }

    fn is_in_time(&self) -> bool {
        self.time_limit.is_none_or(|limit| self.started.elapsed() < limit)
    }

    /// The clock as the tiles of one pass see it.
    pub(crate) fn of_pass(&self, kind: PassKind) -> PassClock<'_> {
        PassClock { clock: self, kind }
    }

    fn count(&self, samples: u64) {
        self.samples_done.fetch_add(samples, Ordering::Relaxed);
        let now = nanoseconds(self.started.elapsed());
        if now < self.next_report.load(Ordering::Relaxed) {
            return;
        }
        // A second thread finds the lock taken and goes on rendering.
        if let Ok(_reporting) = self.reporting.try_lock() {
            self.next_report.store(now + nanoseconds(REPORT_INTERVAL), Ordering::Relaxed);
            self.observer.progress(&self.progress());
        }
    }

    fn progress(&self) -> Progress {
        Progress {
            samples_done: self.samples_done.load(Ordering::Relaxed),
            samples_before: self.samples_before,
            samples_total: self.samples_total,
            elapsed: self.started.elapsed(),
            time_limit: self.time_limit,
        }
    }

    /// The paths that reached a limit of their length.
    pub(crate) fn truncated_paths(&self) -> u64 {
        self.truncated_paths.load(Ordering::Relaxed)
    }

    /// Reports the end, and returns what it reported.
    pub(crate) fn finish(&self) -> Progress {
        let progress = self.progress();
        self.observer.progress(&progress);
        progress
    }
}

/// What a thread did to a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FinishedTile {
    /// The samples that it took; none if the tile was abandoned.
    pub(crate) samples: u64,
    /// The paths of these samples that reached a limit of their length.
    pub(crate) truncated_paths: u64,
}

/// The clock of one pass.
pub(crate) struct PassClock<'a> {
    clock: &'a Clock<'a>,
    kind: PassKind,
}

/// Whether a pass may be cut short by the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PassKind {
    /// Gives every pixel its first sample. It ignores the time, so that no pixel stays empty.
    First,
    /// Ends when time is up.
    Later,
}

impl PassClock<'_> {
    /// Whether the next tile may begin.
    pub(crate) fn may_go_on(&self) -> bool {
        let in_time = self.kind == PassKind::First || self.clock.is_in_time();
        in_time && !self.clock.cancel.is_cancelled()
    }

    /// Whether a batch of samples that takes long may go on. Unlike the first pass as a whole, it may
    /// not exceed the time.
    pub(crate) fn is_over(&self) -> bool {
        !self.clock.may_go_on()
    }

    /// Counts the samples of a finished tile, and reports if a report is due.
    pub(crate) fn count(&self, tile: FinishedTile) {
        self.clock.truncated_paths.fetch_add(tile.truncated_paths, Ordering::Relaxed);
        self.clock.count(tile.samples);
    }
}

fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
