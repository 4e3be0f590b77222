//! Progress while a render runs, and the way to stop it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::film_sums::FilmSums;

/// How far a render has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Samples in the film.
    pub samples_done: u64,
    /// How many of them the film had when this run began.
    pub samples_before: u64,
    /// Samples in the budget; `None` if only time is limited.
    pub samples_total: Option<u64>,
    /// Wall time since the first ray.
    pub elapsed: Duration,
    /// The time budget, if there is one.
    pub time_limit: Option<Duration>,
}

impl Progress {
    /// Samples of this run per second of wall time.
    pub fn rate(&self) -> f64 {
        self.samples_taken() as f64 / self.elapsed.as_secs_f64().max(1e-9)
    }

    /// Samples of this run.
    fn samples_taken(&self) -> u64 {
        self.samples_done.saturating_sub(self.samples_before)
    }

    /// How much is done, from 0 to 1: the greater of the shares of samples and of time.
    pub fn fraction(&self) -> f64 {
        let by_samples = self
            .samples_total
            .map_or(0.0, |total| self.samples_done as f64 / (total as f64).max(1.0));
        let by_time = self
            .time_limit
            .map_or(0.0, |limit| self.elapsed.as_secs_f64() / limit.as_secs_f64().max(1e-9));
        by_samples.max(by_time).clamp(0.0, 1.0)
    }

    /// How long the rest will take at the rate so far; `None` before the first sample.
    pub fn time_left(&self) -> Option<Duration> {
        let by_samples = self
            .samples_total
            .filter(|_| self.samples_taken() > 0)
            .map(|total| total.saturating_sub(self.samples_done) as f64 / self.rate());
        let by_time = self.time_limit.map(|limit| limit.saturating_sub(self.elapsed).as_secs_f64());
        let seconds = match (by_samples, by_time) {
            (Some(samples), Some(time)) => samples.min(time),
            (one, other) => one.or(other)?,
        };
        Duration::try_from_secs_f64(seconds).ok()
    }
}

/// A pass over the picture that has ended.
#[derive(Debug)]
pub struct FinishedPass<'a> {
    /// How many samples every pixel has so far.
    pub samples_per_pixel: u32,
    /// The film so far, for a preview.
    pub film: &'a FilmSums,
}

/// Hears how a render goes. The methods are called from any thread, but never from two at once. They
/// hold up the render while they run. By default they do nothing.
pub trait Observer: Sync {
    /// Called about ten times a second, and once at the end.
    fn progress(&self, _progress: &Progress) {}

    /// Called after every pass.
    fn pass_finished(&self, _pass: &FinishedPass<'_>) {}
}

/// An observer that does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {}

/// A flag that stops a render within milliseconds and keeps what is done. Clones share the flag.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// A flag that is not set.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks the render to stop.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether somebody has asked.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// The flag itself, for a signal handler to set.
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF: Progress = Progress {
        samples_done: 50,
        samples_before: 0,
        samples_total: Some(100),
        elapsed: Duration::from_secs(5),
        time_limit: None,
    };

    #[test]
    fn the_second_half_takes_as_long_as_the_first() {
        assert_eq!(HALF.rate(), 10.0);
        assert_eq!(HALF.fraction(), 0.5);
        assert_eq!(HALF.time_left(), Some(Duration::from_secs(5)));
    }

    #[test]
    fn samples_of_earlier_runs_count_as_done_but_not_for_the_rate() {
        let resumed = Progress { samples_before: 40, ..HALF };
        assert_eq!((resumed.fraction(), resumed.rate()), (0.5, 2.0));
        assert_eq!(resumed.time_left(), Some(Duration::from_secs(25)));
    }

    #[test]
    fn a_time_limit_that_comes_first_decides() {
        let limited = Progress { time_limit: Some(Duration::from_secs(6)), ..HALF };
        assert_eq!(limited.time_left(), Some(Duration::from_secs(1)));
        assert!(limited.fraction() > 0.8);
        let only_time = Progress { samples_total: None, ..limited };
        assert_eq!(only_time.time_left(), Some(Duration::from_secs(1)));
    }

    #[test]
    fn the_time_left_is_unknown_before_the_first_sample() {
        let begun = Progress { samples_done: 0, ..HALF };
        assert_eq!(begun.time_left(), None);
    }

    #[test]
    fn clones_share_the_flag() {
        let cancel = Cancel::new();
        let clone = cancel.clone();
        clone.cancel();
        assert!(cancel.is_cancelled());
    }
}
