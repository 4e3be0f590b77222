//! The driver: passes over the picture until the budget is spent or the host cancels.

mod pass;

use std::time::Instant;

use crate::clock::{Clock, PassKind};
use crate::error::EngineError;
use crate::film_sums::FilmSums;
use crate::host::Host;
use crate::job::{Budget, Job};
use crate::observer::FinishedPass;
use crate::schedule::Schedule;
use crate::source::SampleSource;
use crate::statistics::Statistics;
use pass::render_pass;

/// Renders a job into a new film.
///
/// If the number of samples ends the render, and not the time, the sums are the same, bit for bit,
/// for any number of threads.
///
/// # Errors
///
/// [`EngineError`] if the job cannot be started. Once it has started, it cannot fail.
pub fn render<S: SampleSource>(
    source: &S,
    job: &Job,
    host: &Host<'_>,
) -> Result<(FilmSums, Statistics), EngineError> {
    let film = FilmSums::new(job, source, host.workers.thread_count())?;
    let statistics = render_into(source, &film, job.budget, host)?;
    Ok((film, statistics))
}

/// Renders into a film, which may hold samples of earlier runs: until it has every sample with an
/// index below the budget's number, or time is up.
///
/// # Errors
///
/// [`EngineError::NoBudget`] if there is nothing to spend.
pub fn render_into<S: SampleSource>(
    source: &S,
    film: &FilmSums,
    budget: Budget,
    host: &Host<'_>,
) -> Result<Statistics, EngineError> {
    budget.check()?;
    let clock = Clock::start(film, budget, host.observer, host.cancel);
    let start = film.least_next_sample();
    let mut schedule = Schedule::new(start, budget.samples_per_pixel.unwrap_or(u32::MAX));
    let mut passes = 0;

    while let Some(end) = schedule.next_pass() {
        let is_first = passes == 0 && start == film.first_sample();
        let kind = if is_first { PassKind::First } else { PassKind::Later };
        passes += 1;
        let pass_started = Instant::now();
        host.workers.run(|| render_pass(source, film, end, &clock.of_pass(kind)));
        if !clock.may_go_on() {
            break;
        }
        schedule.adapt(pass_started.elapsed());
        let samples_per_pixel = end - film.first_sample();
        host.observer.pass_finished(&FinishedPass { samples_per_pixel, film });
    }

    let progress = clock.finish();
    let reached = film.least_next_sample();
    let is_complete = budget.samples_per_pixel.is_some_and(|wanted| reached >= wanted);
    Ok(Statistics {
        samples: progress.samples_done - progress.samples_before,
        samples_per_pixel: film.samples_per_pixel(),
        passes,
        threads: host.workers.thread_count(),
        duration: progress.elapsed,
        cancelled: host.cancel.is_cancelled() && !is_complete,
        defects: film.defects(),
        truncated_paths: clock.truncated_paths(),
    })
}
