//! Films in files, and merged films: any division of the samples gives the bits of one render.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicU64, Ordering};

use etendue_engine::{
    Budget, Cancel, ChannelKind, Channels, EngineError, FilmFile, FilmFileError, FilmRecord,
    FilmSums, Host, Job, PixelSplat, PixelSplatSink, Region, Sample, SampleId, SampleSource,
    SamplesPerPixel, Silent, SplatSource, Watch, Workers, render_into,
};
use etendue_image::Picture;
use etendue_spectrum::Spectrum;
use proptest::prelude::*;

/// Noise over twelve orders of magnitude, with defects now and then, a channel of both signs, and
/// splats anywhere.
struct Noise {
    channels: Vec<String>,
    /// Cancels after so many samples.
    stop: Option<(u64, Cancel)>,
    taken: AtomicU64,
}

impl Noise {
    fn new() -> Self {
        Self {
            channels: vec!["channel.Z".to_owned(), "id.I".to_owned()],
            stop: None,
            taken: AtomicU64::new(0),
        }
    }
}

impl SampleSource for Noise {
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
        for (id, channels) in ids.iter().zip(channels.chunks_exact_mut(2)) {
            let [channel, identifier] = channels else { unreachable!("chunks of two") };
            *identifier = (id.index % 7) as f32;
            samples.push(self.sample(*id, channel));
        }
    }

    fn channel_kinds(&self) -> Vec<ChannelKind> {
        [ChannelKind::Mean, ChannelKind::Nearest][..self.channels.len()].to_vec()
    }

    fn splats(&self) -> Option<&dyn SplatSource> {
        Some(self)
    }
}

impl SplatSource for Noise {
    fn trace_splats(&self, id: SampleId, _: &Watch<'_>, sink: &mut PixelSplatSink<'_>) {
        let sample = self.sample(id, &mut 0.0);
        let mixed = (id.x * 7919 + id.y * 104_729 + id.index * 31).wrapping_mul(0x9e37_79b9) >> 8;
        let color =
            sample.color.rgb().map(|value| f64::from(if value.is_nan() { 1.0 } else { value }));
        sink(PixelSplat { x: REGION.x + mixed % REGION.width, y: mixed % 29, color });
    }
}

impl Noise {
    fn sample(&self, id: SampleId, channel: &mut f32) -> Sample {
        if let Some((count, cancel)) = &self.stop
            && self.taken.fetch_add(1, Ordering::Relaxed) >= *count
        {
            cancel.cancel();
        }
        let mut state = (u64::from(id.x) << 40) ^ (u64::from(id.y) << 20) ^ u64::from(id.index);
        let mut next = || {
            state = (state ^ 0x9e37_79b9_7f4a_7c15).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            state ^= state >> 29;
            (state >> 40) as f32 / 16_777_216.0
        };
        let color = [next(), next(), next()].map(|value| value * 10_f32.powf(next() * 12.0 - 6.0));
        *channel = next() - 0.5;
        let (alpha, weight) = (next(), 1.5 - 2.0 * next());
        let color = if next() < 0.01 { [f32::NAN; 3] } else { color };
        // Few distances, so that samples share them.
        let squared_distance = (next() * 4.0).floor();
        Sample { color: Spectrum::from_rgb(color), alpha, weight, squared_distance }
    }
}

const REGION: Region = Region { x: 5, y: 1, width: 21, height: 18 };
const COUNT: u32 = 24;
const ALL: Channels = Channels { alpha: true, variance: true };

fn job(first_sample: u32) -> Job {
    let budget = Budget { samples_per_pixel: None, time: None };
    Job { region: REGION, first_sample, budget, variance: true, memory_limit: 1 << 30 }
}

/// Renders the samples of a film that are missing below an index.
fn render_up_to(film: &FilmSums, end: u32, threads: usize) {
    let workers = Workers::new(NonZeroUsize::new(threads)).unwrap();
    let budget = Budget { samples_per_pixel: Some(end), time: None };
    let host = Host { workers: &workers, observer: &Silent, cancel: &Cancel::new() };
    render_into(&Noise::new(), film, budget, &host).unwrap();
}

/// A film whose tiles suit `tile_threads`, rendered on `threads`.
fn part(first: u32, end: u32, [tile_threads, threads]: [usize; 2]) -> FilmSums {
    let film = FilmSums::new(&job(first), &Noise::new(), tile_threads).unwrap();
    if end > first {
        render_up_to(&film, end, threads);
    }
    film
}

fn whole() -> FilmSums {
    part(0, COUNT, [1, 1])
}

fn picture(film: &FilmSums) -> Picture {
    film.develop(ALL)
}

fn record() -> FilmRecord {
    let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    FilmRecord {
        identity: vec![pair("scene", "abc"), pair("seed", "7")],
        notes: vec![pair("exposure", "-1.5")],
        planned_samples: COUNT,
        seconds: 12.5,
    }
}

fn write(film: &FilmSums) -> Vec<u8> {
    let mut bytes = Vec::new();
    film.write(&record(), &mut bytes).unwrap();
    bytes
}

fn read(bytes: &[u8]) -> Result<(FilmFile, FilmSums), FilmFileError> {
    let mut input = bytes;
    let file = FilmFile::read_header(&mut input)?;
    let film = file.read_sums(&mut input, bytes.len() as u64, 1 << 30)?;
    Ok((file, film))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Parts of any size, rendered on any number of threads with tiles of any size, stopped anywhere and
    /// resumed from their files, merged in any order.
    #[test]
    fn any_split_any_order_any_threads_is_one_render(
        cuts in prop::collection::btree_set(1..COUNT, 0..5),
        threads in prop::collection::vec((prop::sample::select(vec![1, 4, 200]), 1..4_usize), 6),
        pauses in prop::collection::vec(0.0..1.0_f64, 6),
        order in any::<u64>(),
    ) {
        let starts: Vec<u32> = std::iter::once(0).chain(cuts.iter().copied()).collect();
        let ends: Vec<u32> = cuts.iter().copied().chain([COUNT]).collect();
        let mut parts: Vec<FilmSums> = Vec::new();
        for (index, (&start, &end)) in starts.iter().zip(&ends).enumerate() {
            let (tiles, count) = threads[index];
            let pause = start + (f64::from(end - start) * pauses[index]) as u32;
            let (_, film) = read(&write(&part(start, pause, [tiles, count]))).unwrap();
            render_up_to(&film, end, count % 3 + 1);
            parts.push(film);
        }
        let mut state = order;
        while parts.len() > 1 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let taken = parts.swap_remove((state >> 33) as usize % parts.len());
            let other = (state >> 13) as usize % parts.len();
            parts[other].merge(&taken).unwrap();
        }
        let expected = whole();
        prop_assert_eq!(picture(&parts[0]), picture(&expected));
        prop_assert_eq!(parts[0].defects(), expected.defects());
        prop_assert_eq!(parts[0].samples_per_pixel(), SamplesPerPixel::all(COUNT));
    }

    /// A render stopped anywhere, in the middle of a pass too, and resumed from its file.
    #[test]
    fn a_render_stopped_in_the_middle_of_a_pass_resumes_to_the_same_picture(
        stop in 1..(u64::from(COUNT) * REGION.pixel_count()),
        threads in 1..4_usize,
        tiles in prop::sample::select(vec![1, 200]),
    ) {
        let cancel = Cancel::new();
        let source = Noise { stop: Some((stop, cancel.clone())), ..Noise::new() };
        let film = FilmSums::new(&job(0), &source, tiles).unwrap();
        let workers = Workers::new(NonZeroUsize::new(threads)).unwrap();
        let budget = Budget { samples_per_pixel: Some(COUNT), time: None };
        let host = Host { workers: &workers, observer: &Silent, cancel: &cancel };
        render_into(&source, &film, budget, &host).unwrap();
        let (file, resumed) = read(&write(&film)).unwrap();
        prop_assert_eq!([file.samples_per_pixel], [film.samples_per_pixel().least]);
        render_up_to(&resumed, COUNT, 2);
        prop_assert_eq!(picture(&resumed), picture(&whole()));
    }
}

#[test]
fn a_written_film_is_read_back() {
    let film = part(3, 9, [200, 2]);
    let (file, again) = read(&write(&film)).unwrap();
    assert_eq!(file.record, record());
    assert_eq!((file.region, file.first_sample, file.samples_per_pixel), (REGION, 3, 6));
    assert_eq!((file.channel_names.as_slice(), file.variance), (Noise::new().channels(), true));
    assert_eq!(picture(&again), picture(&film));
    assert!(film.defects().total() > 0, "otherwise the next line proves nothing");
    assert_eq!(again.defects(), film.defects());
    assert_eq!(write(&again), write(&film));
}

#[test]
fn a_file_that_is_short_long_or_changed_anywhere_is_refused() {
    let bytes = write(&part(0, 2, [1, 1]));
    for length in [0, 11, 12, 19, 20, 100, bytes.len() / 2, bytes.len() - 1] {
        assert!(read(&bytes[..length]).is_err(), "{length} bytes");
    }
    let longer = [&bytes[..], b"x"].concat();
    assert!(matches!(read(&longer), Err(FilmFileError::Torn)));
    for place in (0..400).chain((400..bytes.len()).step_by(97)) {
        let mut changed = bytes.clone();
        changed[place] ^= 0x10;
        assert!(read(&changed).is_err(), "byte {place}");
    }
}

#[test]
fn refusals_tell_foreign_files_other_versions_and_torn_ones_apart() {
    assert!(matches!(read(b"PF\n3 2\n-1.0\n"), Err(FilmFileError::NotSums)));
    let bytes = write(&part(0, 1, [1, 1]));
    let mut newer = bytes.clone();
    newer[12] = 9;
    let error = read(&newer).unwrap_err();
    assert!(error.to_string().contains("version 9"), "{error}");
    let mut torn = bytes;
    let last = torn.len() - 40;
    torn[last] ^= 1;
    assert!(read(&torn).is_err());
}

/// A header that claims a large film in a small file.
#[test]
fn a_small_file_cannot_make_the_reader_take_much_memory() {
    let mut bytes = write(&part(0, 1, [1, 1]));
    // No other four numbers of the file are those of the region.
    let needle: Vec<u8> = [5_u32, 1, 21, 18].into_iter().flat_map(u32::to_le_bytes).collect();
    let place = bytes.windows(16).position(|window| window == needle).unwrap();
    bytes[place + 8..place + 16].fill(0x7f);
    assert!(matches!(read(&bytes), Err(FilmFileError::Torn)));
}

#[test]
fn films_that_do_not_belong_together_are_not_merged() {
    let mut film = part(0, 2, [1, 1]);
    let other = Job { region: Region { x: 6, ..REGION }, ..job(2) };
    let elsewhere = FilmSums::new(&other, &Noise::new(), 1).unwrap();
    assert_eq!(film.merge(&elsewhere), Err(EngineError::OtherFilm));
    let plain = FilmSums::new(&job(2), &Noise { channels: Vec::new(), ..Noise::new() }, 1).unwrap();
    assert_eq!(film.merge(&plain), Err(EngineError::OtherFilm));
    let without = Job { variance: false, ..job(2) };
    let without = FilmSums::new(&without, &Noise::new(), 1).unwrap();
    assert_eq!(film.merge(&without), Err(EngineError::OtherFilm));
}

/// Replaces some bytes of a file and makes its checksum right again.
fn forge(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let place = bytes.windows(from.len()).position(|window| window == from).unwrap();
    let body = &bytes[..bytes.len() - blake3::OUT_LEN];
    let mut forged = [&body[..place], to, &body[place + from.len()..]].concat();
    let checksum = blake3::hash(&forged);
    forged.extend_from_slice(checksum.as_bytes());
    forged
}

#[test]
fn headers_that_no_picture_can_have_are_refused() {
    let bytes = write(&part(0, 2, [1, 1]));
    assert!(read(&forge(&bytes, b"channel.Z", b"channel.Q")).is_ok());
    for name in [b"variance.", b"\x1bhannel.Z"] {
        assert!(matches!(read(&forge(&bytes, b"channel.Z", name)), Err(FilmFileError::Invalid(_))));
    }
    let region = |x: u32| [x, 1, 21, 18].into_iter().flat_map(u32::to_le_bytes).collect::<Vec<_>>();
    assert!(read(&forge(&bytes, &region(5), &region(6))).is_ok());
    let beyond = region(i32::MAX as u32 - 20);
    assert!(matches!(read(&forge(&bytes, &region(5), &beyond)), Err(FilmFileError::Invalid(_))));
}

#[test]
fn sums_that_no_picture_can_hold_are_refused() {
    let bytes = write(&part(0, 2, [1, 1]));
    // The windows of four sums of usual light become the highest ones.
    let windows = |limit: u16| limit.to_le_bytes().repeat(4);
    let forged = forge(&bytes, &windows(1039), &windows(2063));
    assert!(matches!(read(&forged), Err(FilmFileError::Invalid("a pixel is not finite"))));
}
