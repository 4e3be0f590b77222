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
    /// Every pixel gets the samples whose indices lie below this number; `None` for as many as the
    /// time allows.
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
    /// The index of every pixel's first sample: 0, unless this is a part of a picture whose other
    /// samples are taken elsewhere.
    pub first_sample: u32,
    /// When to stop.
    pub budget: Budget,
    /// Whether variances will be wanted: the sums of squares cost memory.
    pub variance: bool,
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
    let film = FilmSums::new(job, source, workers.thread_count())?;
    let statistics = add_samples(source, (&film, job.budget), workers, observer, cancel)?;
    Ok((film, statistics))
}

/// Goes on with a film, which may hold samples of earlier runs, until the budget is spent: every
/// sample index below the budget's number is there once, or the time is over.
///
/// # Errors
///
/// [`EngineError::NoBudget`] if there is nothing to spend.
pub fn add_samples<S: SampleSource>(
    source: &S,
    (film, budget): (&FilmSums, Budget),
    workers: &Workers,
    observer: &dyn Observer,
    cancel: &Cancel,
) -> Result<Statistics, EngineError> {
    budget.check()?;
    let clock = Clock::start((film, budget), observer, cancel);
    let [start, _] = film.next_samples();
    let mut schedule = Schedule::new(start, budget.samples_per_pixel.unwrap_or(u32::MAX));
    let mut passes = 0;

    while let Some(end) = schedule.next_pass() {
        let first = FirstPass(passes == 0 && start == film.first_sample());
        passes += 1;
        let pass_started = Instant::now();
        workers.run(|| {
            film.add_samples(source, end, &|| clock.may_go_on(first), &|count| clock.count(count));
        });
        if !clock.may_go_on(FirstPass(false)) {
            break;
        }
        schedule.adapt(pass_started.elapsed());
        let samples_per_pixel = end - film.first_sample();
        observer.pass_finished(&FinishedPass { samples_per_pixel, film });
    }

    let progress = clock.finish();
    let [reached, _] = film.next_samples();
    let is_complete = budget.samples_per_pixel.is_some_and(|wanted| reached >= wanted);
    Ok(Statistics {
        samples: progress.samples_done - progress.samples_before,
        samples_per_pixel: film.samples_per_pixel(),
        passes,
        threads: workers.thread_count(),
        duration: progress.elapsed,
        cancelled: cancel.is_cancelled() && !is_complete,
        defects: film.defects(),
    })
}
