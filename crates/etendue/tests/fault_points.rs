//! If a process dies at any point while writing a checkpoint, a complete checkpoint remains, and
//! the resumed render gives the same picture.
//!
//! Each case runs in a separate process: this program, started again to run `write_and_die` alone.
#![cfg(unix)]
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]

use std::cell::Cell;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use etendue::document::MemoryResources;
use etendue::durable::{WriteStep, remove_abandoned, write_durably_with};
use etendue::image::Picture;
use etendue::{
    Cancel, FilmSums, LoadedScene, RenderJob, RenderOptions, SamplesPerPixel, SceneOptions, Silent,
    Statistics, SumsFile, Workers, load_text,
};

/// The environment variables that instruct the second process.
const PLACE: &str = "ETENDUE_TEST_CHECKPOINT";
const POINT: &str = "ETENDUE_TEST_FAULT_POINT";

/// Samples in the old checkpoint, in the new one, and at the end.
const COUNTS: [u32; 3] = [2, 3, 5];

const SCENE: &str = r#"<scene version="3.0.0">
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0, 1, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="24"/></film>
    </sensor>
    <emitter type="constant"/>
    <shape type="sphere"><bsdf type="diffuse"/></shape>
</scene>"#;

/// Where the process dies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Point {
    /// After this many bytes have been written.
    Bytes(usize),
    /// After a step.
    After(WriteStep),
}

/// Positions in the first chunk of the file, in its middle and at its end, and every step.
const POINTS: [Point; 9] = [
    Point::After(WriteStep::Created),
    Point::Bytes(1),
    Point::Bytes(1000),
    Point::Bytes(40_000),
    Point::Bytes(70_000),
    Point::After(WriteStep::Written),
    Point::After(WriteStep::Synced),
    Point::After(WriteStep::Renamed),
    Point::After(WriteStep::Done),
];

fn loaded_scene() -> LoadedScene {
    let files = MemoryResources::default();
    load_text(SCENE, PathBuf::new(), &files, &SceneOptions::default()).scene.unwrap()
}

/// Continues a film, or starts a new one, up to this many samples.
fn render(scene: &LoadedScene, film: Option<FilmSums>, count: u32) -> (FilmSums, Picture) {
    let options = RenderOptions {
        samples_per_pixel: Some(count),
        planned_samples: Some(COUNTS[2]),
        ..RenderOptions::default()
    };
    let workers = Workers::new(NonZeroUsize::new(2)).unwrap();
    let job = RenderJob::new(scene, &options).unwrap();
    let film = film.unwrap_or_else(|| job.new_film(&workers).unwrap());
    job.render_into(&film, &workers, &Silent, &Cancel::new()).unwrap();
    let picture = job.develop(&film, Statistics::default(), 0.0).picture;
    (film, picture)
}

fn record(scene: &LoadedScene) -> etendue::FilmRecord {
    let options = RenderOptions { planned_samples: Some(COUNTS[2]), ..RenderOptions::default() };
    RenderJob::new(scene, &options).unwrap().record(1.0)
}

#[test]
fn a_process_that_dies_anywhere_leaves_a_whole_checkpoint() {
    let scene = loaded_scene();
    let (_, expected) = render(&scene, None, COUNTS[2]);
    for (index, point) in POINTS.into_iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        let file = SumsFile::new(folder.path().join("a.checkpoint"));
        let (film, _) = render(&scene, None, COUNTS[0]);
        file.write(&film, &record(&scene)).unwrap();

        let program = std::env::current_exe().unwrap();
        let arguments = ["--exact", "write_and_die", "--include-ignored", "--test-threads", "1"];
        let mut second = Command::new(program);
        second.args(arguments).env(PLACE, file.path()).env(POINT, index.to_string());
        let status = second.stdout(Stdio::null()).stderr(Stdio::null()).status().unwrap();
        assert_eq!(status.signal(), Some(9), "{point:?}: the second process was to be killed");

        let (header, film) = file.read(1 << 30).unwrap();
        let is_new = matches!(point, Point::After(WriteStep::Renamed | WriteStep::Done));
        let held = if is_new { COUNTS[1] } else { COUNTS[0] };
        assert_eq!(
            (header.samples_per_pixel, film.samples_per_pixel()),
            (held, SamplesPerPixel::all(held))
        );
        let (_, picture) = render(&scene, Some(film), COUNTS[2]);
        assert_eq!(picture.channels, expected.channels, "{point:?}");
        remove_abandoned(file.path());
        let left = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(left, 1, "{point:?}: abandoned files are removed");
    }
}

/// Resumes the checkpoint and dies while writing the next one.
#[test]
#[ignore = "the other test starts it in a process of its own, and it dies"]
fn write_and_die() {
    let (Ok(place), Ok(point)) = (std::env::var(PLACE), std::env::var(POINT)) else {
        return;
    };
    let point = POINTS[point.parse::<usize>().unwrap()];
    let scene = loaded_scene();
    let (_, film) = SumsFile::new(&place).read(1 << 30).unwrap();
    let (film, _) = render(&scene, Some(film), COUNTS[1]);
    let record = record(&scene);
    let write =
        |out: &mut dyn Write| film.write(&record, &mut Fatal { out, point, written: Cell::new(0) });
    let reached = |step: WriteStep| {
        if point == Point::After(step) {
            die();
        }
    };
    write_durably_with(Path::new(&place), write, &reached).unwrap();
}

/// A writer that kills the process after a number of bytes.
struct Fatal<'a> {
    out: &'a mut dyn Write,
    point: Point,
    written: Cell<usize>,
}

impl Write for Fatal<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let before = self.written.get();
        if let Point::Bytes(limit) = self.point
            && before + bytes.len() >= limit
        {
            self.out.write_all(&bytes[..limit - before])?;
            self.out.flush()?;
            die();
        }
        self.written.set(before + bytes.len());
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Equivalent to `kill -9`.
fn die() -> ! {
    let _ = Command::new("kill").args(["-9", &std::process::id().to_string()]).status();
    unreachable!("the signal cannot be refused")
}
