//! The driver: passes over the picture until the budget is spent or somebody says stop.

use std::time::{Duration, Instant};

use crate::clock::{Clock, FirstPass};
use crate::region::Region;
use crate::schedule::Schedule;
use crate::source::SampleSource;
use crate::statistics::Statistics;
use crate::{Cancel, EngineError, FilmSums, FinishedPass, Observer, Workers};

/// How much is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Samples for every pixel; `None` for as many as the time allows.
    pub samples_per_pixel: Option<u32>,
    /// Wall time from the first ray. Every pixel gets one sample even if that takes longer.
    pub time: Option<Duration>,
}

impl Budget {
    /// Whether there is an end, and something before it.
    fn check(&self) -> Result<(), EngineError> {
        match (self.samples_per_pixel, self.time) {
            (Some(0), _) | (None, None) => Err(EngineError::NoBudget),
            _ => Ok(()),
        }
    }
}

/// What to render, apart from the scene.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// The pixels.
    pub region: Region,
    /// When to stop.
    pub budget: Budget,
    /// The bytes that the film may take.
    pub memory_limit: u64,
}

/// Renders samples of any source into sums.
///
/// The sums are the same, bit for bit, for any number of threads, as long as only the number of
/// samples ends the render.
///
/// # Errors
///
/// [`EngineError`] if the job cannot be started; nothing that happens later is an error.
pub fn render_samples<S: SampleSource>(
    source: &S,
    job: &Job,
    workers: &Workers,
    observer: &dyn Observer,
    cancel: &Cancel,
) -> Result<(FilmSums, Statistics), EngineError> {
    job.budget.check()?;
    let thread_count = workers.thread_count();
    let mut film = FilmSums::new(job.region, source.layers(), thread_count, job.memory_limit)?;
    let mut schedule = Schedule::new(job.budget.samples_per_pixel.unwrap_or(u32::MAX));
    let clock = Clock::start(job, observer, cancel);
    let mut passes = 0;

    while let Some(indices) = schedule.next_pass() {
        passes += 1;
        let pass_started = Instant::now();
        let first = FirstPass(indices.start == 0);
        let samples_per_pixel = indices.end;
        workers.run(|| {
            let go_on = || clock.may_go_on(first);
            film.add_samples(source, indices, &go_on, &|samples| clock.count(samples));
        });
        if !clock.may_go_on(FirstPass(false)) {
            break;
        }
        schedule.adapt(pass_started.elapsed());
        observer.pass_finished(&FinishedPass { samples_per_pixel, film: &film });
    }

    let end = clock.finish();
    let samples_per_pixel = film.samples_per_pixel();
    let is_complete = job.budget.samples_per_pixel == Some(samples_per_pixel[0]);
    let statistics = Statistics {
        samples: end.samples_done,
        samples_per_pixel,
        passes,
        threads: thread_count,
        duration: end.elapsed,
        cancelled: cancel.is_cancelled() && !is_complete,
        defects: film.defects(),
    };
    Ok((film, statistics))
}
