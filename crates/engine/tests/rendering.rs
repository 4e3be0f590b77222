//! The engine with formulas as sources: exactness, budgets, cancelling, defects.

use std::num::NonZeroUsize;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use etendue_engine::{
    Budget, Cancel, Channels, Defect, DefectiveSample, EngineError, FilmSums, FinishedPass, Host,
    Job, Observer, Progress, Region, Sample, SampleId, SampleSource, SamplesPerPixel, Silent,
    Statistics, Watch, Workers, render_into,
};
use etendue_sampling::hash::mix64;
use etendue_spectrum::Spectrum;

/// A source that computes each sample by a function.
struct Formula<F> {
    channels: Vec<String>,
    sample: F,
}

impl<F: Fn(SampleId) -> Sample + Sync> SampleSource for Formula<F> {
    fn channels(&self) -> &[String] {
        &self.channels
    }

    fn take_samples(
        &self,
        ids: &[SampleId],
        channels: &mut [f32],
        _: &Watch<'_>,
        samples: &mut Vec<Sample>,
    ) {
        for (id, row) in ids.iter().zip(channels) {
            *row = id.y as f32;
            samples.push((self.sample)(*id));
        }
    }
}

fn formula<F: Fn(SampleId) -> Sample + Sync>(sample: F) -> Formula<F> {
    Formula { channels: vec!["row.Y".to_owned()], sample }
}

/// Grey light of full coverage and weight.
fn grey(value: f32) -> Sample {
    Sample { color: Spectrum::splat(value), alpha: 1.0, weight: 1.0, squared_distance: 0.0 }
}

/// A number in [0, 1) whose sums need many digits.
fn noise(id: SampleId) -> f32 {
    let mixed = (id.x ^ id.y << 10 ^ id.index << 20).wrapping_mul(0x9e37_79b9);
    (mixed ^ mixed >> 15) as f32 / 4.3e9
}

const REGION: Region = Region { x: 2, y: 3, width: 37, height: 21 };

fn job(samples_per_pixel: u32) -> Job {
    let budget = Budget { samples_per_pixel: Some(samples_per_pixel), time: None };
    Job { region: REGION, first_sample: 0, budget, variance: true, memory_limit: 1 << 30 }
}

fn workers(thread_count: usize) -> Workers {
    Workers::new(NonZeroUsize::new(thread_count)).unwrap()
}

/// Renders on threads that nobody watches or stops.
fn try_render(
    source: &impl SampleSource,
    job: &Job,
    threads: usize,
) -> Result<(FilmSums, Statistics), EngineError> {
    let (workers, cancel) = (workers(threads), Cancel::new());
    let host = Host { workers: &workers, observer: &Silent, cancel: &cancel };
    etendue_engine::render(source, job, &host)
}

fn render(source: &impl SampleSource, job: &Job, threads: usize) -> (FilmSums, Statistics) {
    try_render(source, job, threads).unwrap()
}

const ALL: Channels = Channels { alpha: true, variance: true };

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let source = formula(|id| grey(noise(id) * 1e3_f32.powf(noise(id) * 7.0)));
    let pictures: Vec<_> = [1, 2, 5].map(|n| render(&source, &job(50), n).0.develop(ALL)).into();
    assert_eq!(pictures[0], pictures[1]);
    assert_eq!(pictures[0], pictures[2]);
}

#[test]
fn pixels_hold_the_mean_of_their_own_samples() {
    let source = formula(|id| grey((id.x * 1000 + id.y * 10 + id.index) as f32));
    let (film, statistics) = render(&source, &job(5), 2);
    let picture = film.develop(ALL);
    assert_eq!(picture.validate(), Ok(()));
    assert_eq!(picture.data_origin, [2, 3]);
    let names: Vec<_> = picture.channels.iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(names[..5], ["R", "G", "B", "A", "row.Y"]);
    for (index, &value) in picture.channels[0].data.iter().enumerate() {
        let (x, y) = (index % 37 + 2, index / 37 + 3);
        assert_eq!(value, (x * 1000 + y * 10 + 2) as f32, "the indices 0 to 4 have the mean 2");
        assert_eq!(picture.channels[4].data[index], y as f32);
    }
    assert_eq!(statistics.samples, 5 * 37 * 21);
    assert_eq!(statistics.samples_per_pixel, SamplesPerPixel::all(5));
    assert!(!statistics.cancelled);
}

#[test]
fn the_variance_comes_from_the_means_of_samples_with_even_and_odd_index() {
    // Means of 0 and 6, and a mean of all samples of 3 or, for three samples, 2.
    let source = formula(|id| grey(if id.index % 2 == 1 { 6.0 } else { 0.0 }));
    for (samples, expected) in [(1, 0.0), (2, 9.0), (3, 8.0), (10, 9.0)] {
        let picture = render(&source, &job(samples), 1).0.develop(ALL);
        let variance = picture.channel("variance.G").unwrap();
        assert!(variance.data.iter().all(|&value| value == expected), "{samples}: {variance:?}");
    }
}

#[test]
fn the_variance_of_independent_samples_is_found_on_average() {
    let uniform = |id: SampleId| {
        let place = u64::from(id.x) << 40 ^ u64::from(id.y) << 20 ^ u64::from(id.index);
        (mix64(place) >> 40) as f32 / 16_777_216.0
    };
    let picture = render(&formula(|id| grey(uniform(id))), &job(10), 1).0.develop(ALL);
    let variances = &picture.channel("variance.G").unwrap().data;
    let mean = variances.iter().sum::<f32>() / variances.len() as f32;
    // Uniform samples have the variance 1/12.
    assert!((mean * 120.0 - 1.0).abs() < 0.15, "{mean}");
}

#[test]
fn variances_beyond_single_precision_are_its_greatest_number() {
    let source = formula(|id| grey(if id.index % 2 == 1 { 1e30 } else { 0.0 }));
    let picture = render(&source, &job(4), 1).0.develop(ALL);
    let variances = &picture.channel("variance.G").unwrap().data;
    assert!(variances.iter().all(|&value| value == f32::MAX));
}

#[test]
fn filter_weights_apply_to_every_channel_and_may_be_negative() {
    let weights = [3.0, -1.0];
    let source = formula(|id| Sample { weight: weights[id.index as usize % 2], ..grey(2.0) });
    let picture = render(&source, &job(8), 2).0.develop(ALL);
    assert_eq!(picture.channel("R").unwrap().data[0], 2.0);
    assert_eq!(picture.channel("A").unwrap().data[0], 1.0);
    assert_eq!(picture.channel("row.Y").unwrap().data[0], 3.0);
}

#[test]
fn defective_samples_are_counted_named_and_left_out() {
    let source = formula(|id| match id.index {
        1 => grey(f32::NAN),
        2 => grey(f32::INFINITY),
        3 => grey(-1.0),
        _ => grey(6.0),
    });
    let (film, statistics) = render(&source, &job(5), 2);
    assert!(film.develop(ALL).channels[0].data.iter().all(|&value| value == 6.0));
    let pixels = REGION.pixel_count();
    assert_eq!((statistics.defects.non_finite, statistics.defects.negative), (2 * pixels, pixels));
    let id = SampleId { index: 1, y: 3, x: 2 };
    let first = DefectiveSample { id, defect: Defect::NonFinite };
    assert_eq!(statistics.defects.first[0], first);
}

#[test]
fn a_channel_that_is_not_finite_is_a_defect_and_a_negative_one_is_none() {
    struct OneChannel;
    impl SampleSource for OneChannel {
        fn channels(&self) -> &[String] {
            const { &[String::new()] }
        }
        fn take_samples(
            &self,
            ids: &[SampleId],
            channels: &mut [f32],
            _: &Watch<'_>,
            samples: &mut Vec<Sample>,
        ) {
            for (id, channel) in ids.iter().zip(channels) {
                *channel = if id.index == 0 { f32::NAN } else { -4.0 };
                samples.push(grey(1.0));
            }
        }
    }
    let (_, statistics) = render(&OneChannel, &job(3), 1);
    assert_eq!(statistics.defects.total(), REGION.pixel_count());
}

/// Cancels after the third pass, and records all reports.
#[derive(Default)]
struct CancelAtThird {
    cancel: Cancel,
    passes: Mutex<Vec<u32>>,
    last: Mutex<Option<Progress>>,
}

impl Observer for CancelAtThird {
    fn progress(&self, progress: &Progress) {
        *self.last.lock().unwrap() = Some(*progress);
    }

    fn pass_finished(&self, pass: &FinishedPass<'_>) {
        let mut passes = self.passes.lock().unwrap();
        passes.push(pass.samples_per_pixel);
        assert_eq!(pass.film.samples_per_pixel(), SamplesPerPixel::all(pass.samples_per_pixel));
        if passes.len() == 3 {
            self.cancel.cancel();
        }
    }
}

#[test]
fn a_cancelled_render_keeps_what_is_done() {
    let source = formula(|_| grey(1.0));
    let observer = CancelAtThird::default();
    let workers = workers(2);
    let host = Host { workers: &workers, observer: &observer, cancel: &observer.cancel };
    let (film, statistics) = etendue_engine::render(&source, &job(4000), &host).unwrap();
    assert!(statistics.cancelled);
    let done = observer.passes.lock().unwrap()[2];
    let expected = SamplesPerPixel::all(done);
    assert_eq!(statistics.samples_per_pixel, expected, "a pass that has not begun leaves no trace");
    assert!(film.develop(ALL).channels[0].data.iter().all(|&value| value == 1.0));
    assert_eq!(observer.last.lock().unwrap().unwrap().samples_done, statistics.samples);
}

#[test]
fn a_time_limit_ends_the_render_but_not_before_every_pixel_has_a_sample() {
    let source = formula(|_| {
        std::thread::sleep(Duration::from_micros(50));
        grey(1.0)
    });
    for milliseconds in [0, 150] {
        let time = Some(Duration::from_millis(milliseconds));
        let budget = Budget { samples_per_pixel: None, time };
        let started = Instant::now();
        let (_, statistics) = render(&source, &Job { budget, ..job(1) }, 2);
        assert!(statistics.samples_per_pixel.least >= 1);
        assert!(!statistics.cancelled, "the budget was spent");
        // A pass takes about 60 ms; a busy machine may add seconds.
        assert!(started.elapsed() < Duration::from_secs(10));
    }
}

/// Samples of the lower half take so long that they are abandoned when the time is up.
#[test]
fn a_tile_whose_samples_take_too_long_is_left_as_it_was() {
    struct Endless;
    impl SampleSource for Endless {
        fn channels(&self) -> &[String] {
            &[]
        }

        fn take_samples(
            &self,
            ids: &[SampleId],
            _: &mut [f32],
            watch: &Watch<'_>,
            samples: &mut Vec<Sample>,
        ) {
            let is_endless = |id: &SampleId| id.y >= REGION.y + 16 && id.index >= 40;
            while ids.iter().any(is_endless) && !watch.must_abandon() {
                std::thread::yield_now();
            }
            samples.extend(ids.iter().map(|id| grey(noise(*id))));
        }
    }
    let time = Some(Duration::from_millis(300));
    let budget = Budget { samples_per_pixel: Some(60), time };
    let (film, statistics) = render(&Endless, &Job { budget, ..job(60) }, 2);
    let SamplesPerPixel { least, most } = statistics.samples_per_pixel;
    assert!(0 < least && least <= 40, "{least}");
    let taken = film.develop(ALL);
    // The film is the one without the samples that were abandoned, also within a tile.
    let (whole, _) = render(&formula(|id| grey(noise(id))), &job(least), 2);
    let row = (REGION.width * (REGION.height - 1)) as usize;
    assert_eq!(taken.channels[0].data[row..], whole.develop(ALL).channels[0].data[row..]);
    assert!(least <= most && !statistics.cancelled);
}

#[test]
fn jobs_that_cannot_be_done_are_errors() {
    let source = formula(|_| grey(1.0));
    let try_job = |job: Job| try_render(&source, &job, 1).map(|_| ()).unwrap_err();
    assert_eq!(try_job(job(0)), EngineError::NoBudget);
    let endless = Budget { samples_per_pixel: None, time: None };
    assert_eq!(try_job(Job { budget: endless, ..job(1) }), EngineError::NoBudget);
    let empty = Region { width: 0, ..REGION };
    assert_eq!(try_job(Job { region: empty, ..job(1) }), EngineError::BadRegion);
    let huge = Region { x: 0, y: 0, width: 2_000_000_000, height: 2_000_000_000 };
    let error = try_job(Job { region: huge, ..job(1) });
    assert!(matches!(error, EngineError::FilmTooLarge { .. }));
    assert!(error.to_string().contains("2000000000x2000000000"));
}

/// Any order of runs over any ranges of samples gives the same sums.
#[test]
fn a_film_that_is_rendered_in_steps_is_the_one_rendered_at_once() {
    let source = formula(|id| grey(noise(id) * 1e3_f32.powf(noise(id) * 7.0)));
    let whole = render(&source, &job(50), 2).0.develop(ALL);
    let film = FilmSums::new(&job(50), &source, 128).unwrap();
    for (end, threads) in [(7, 1), (7, 2), (20, 5), (50, 2)] {
        let budget = Budget { samples_per_pixel: Some(end), time: None };
        let (workers, cancel) = (workers(threads), Cancel::new());
        let host = Host { workers: &workers, observer: &Silent, cancel: &cancel };
        render_into(&source, &film, budget, &host).unwrap();
        assert_eq!(film.samples_per_pixel(), SamplesPerPixel::all(end));
    }
    assert_eq!(film.develop(ALL), whole);
}

#[test]
fn a_part_takes_the_samples_from_its_first_one() {
    let source = formula(|id| grey(id.index as f32));
    let (film, statistics) = render(&source, &Job { first_sample: 10, ..job(20) }, 2);
    assert_eq!((film.first_sample(), film.samples_per_pixel()), (10, SamplesPerPixel::all(10)));
    assert_eq!(statistics.samples, 10 * REGION.pixel_count());
    assert_eq!(film.develop(ALL).channels[0].data[0], 14.5, "the mean of 10 to 19");
}
