//! Renders killed with SIGKILL at random moments and resumed until they are done, compared with an
//! undisturbed render: every bit must be equal. The test prints what the kills cost, beyond the interval
//! between checkpoints; it does not judge it, because a busy machine or a slow disk decides.
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "tests read and write files, and print"
)]

#[path = "process/run.rs"]
#[allow(dead_code, reason = "shared with the process tests, which use all of it")]
mod run;

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use etendue_testkit::TestRng;
use run::{Workplace, binary};
use serde_json::Value;

/// How many renders are killed and resumed; the environment variable `ETENDUE_KILLS` overrides it.
const COUNT: u64 = 20;

/// Intervals between checkpoints, in milliseconds. With the short ones, something is being written
/// at nearly every moment.
const INTERVALS: [u64; 4] = [5, 20, 100, 300];

/// The name of the picture.
const PICTURE: &str = "killed.pfm";

/// One kind of render.
struct Case {
    scene: &'static str,
    options: &'static [&'static str],
}

/// Renders of some seconds on one thread, of all that sums may hold.
const CASES: [Case; 3] = [
    Case { scene: "cornell-box", options: &["--size", "96x96", "--spp", "96"] },
    Case { scene: "glass-and-metal", options: &["--size", "100x60", "--spp", "64", "--variance"] },
    Case {
        scene: "soft-shadows",
        options: &["--size", "90x50", "--spp", "80", "--filter", "lanczos"],
    },
];

/// What all kills together showed.
#[derive(Debug, Default)]
struct Tally {
    kills: u64,
    /// Kills in the middle of a write, by what it left behind.
    during_writes: u64,
    before_the_first: u64,
    longest_loss: Duration,
    longest_write: Duration,
    /// How far the loss of each kill went beyond the interval.
    excesses: Vec<Duration>,
}

#[test]
#[ignore = "slow; `cargo test -- --include-ignored` runs it, and ETENDUE_KILLS says how often"]
fn killed_renders_resume_to_the_same_picture() {
    let count = std::env::var("ETENDUE_KILLS").map_or(COUNT, |text| text.parse().unwrap());
    let workplace = Workplace::new();
    let expected = CASES.each_ref().map(|case| {
        let status = render(case, &workplace.path("whole.pfm"), &["--resume=never"]).status();
        assert!(status.unwrap().success());
        let picture = workplace.read("whole.pfm");
        fs::remove_file(workplace.path("whole.pfm")).unwrap();
        picture
    });
    let mut tally = Tally::default();
    let mut random = TestRng::new(1);
    for round in 0..count {
        let index = (round % CASES.len() as u64) as usize;
        kill_one(&CASES[index], &workplace, &mut random, &mut tally);
        let scene = CASES[index].scene;
        assert_eq!(workplace.files(), [PICTURE], "render {round} of {scene} has left files");
        let is_equal = workplace.read(PICTURE) == expected[index];
        assert!(is_equal, "render {round} of {scene} is another picture");
        fs::remove_file(workplace.path(PICTURE)).unwrap();
    }
    tally.excesses.sort();
    println!("{count} renders, all pictures equal; {tally:?}");
    assert!(tally.kills >= count / 2, "too few kills came before the end of their render");
}

/// Kills one render up to five times, then lets it finish.
fn kill_one(case: &Case, workplace: &Workplace, random: &mut TestRng, tally: &mut Tally) {
    let path = workplace.path(PICTURE);
    for _ in 0..=random.next_u32() % 5 {
        let interval = Duration::from_millis(INTERVALS[random.next_u32() as usize % 4]);
        let every = format!("{}ms", interval.as_millis());
        let threads = (1 + random.next_u32() % 3).to_string();
        let more =
            ["--resume=auto", "--checkpoint-every", &every, "-t", &threads, "--json-progress"];
        let mut child = render(case, &path, &more).stdout(Stdio::piped()).spawn().unwrap();
        let checkpoints = listen(&mut child);
        let time = interval.mul_f32(4.0 * random.next_f32()) + interval / 4;
        let moment = match random.next_u32() % 4 {
            0 => Moment::AfterStart(time),
            _ => Moment::AfterCheckpoint(time),
        };
        match kill_after(&mut child, moment, &checkpoints) {
            Some(killed) => tally.add(&killed, interval),
            None => return,
        }
        let unfinished = workplace.files().iter().any(|name| name.ends_with(".tmp"));
        tally.during_writes += u64::from(unfinished);
    }
    let status = render(case, &path, &["--resume=auto"]).status().unwrap();
    assert!(status.success(), "a render cannot be resumed");
}

/// When a render is killed.
#[derive(Clone, Copy, Debug)]
enum Moment {
    /// This long after its start, with or without something to resume.
    AfterStart(Duration),
    /// This long after its first checkpoint.
    AfterCheckpoint(Duration),
}

/// A checkpoint: when its writing began and how long it took; `None` for the start of rendering.
type Checkpoint = (Instant, Option<Duration>);

/// Hears when rendering starts and checkpoints are written.
fn listen(child: &mut Child) -> Receiver<Checkpoint> {
    let output = child.stdout.take().unwrap();
    let (sender, receiver) = channel();
    thread::spawn(move || {
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            let now = Instant::now();
            let event: Value = serde_json::from_str(&line).unwrap_or_default();
            let seconds = event["seconds"].as_f64().unwrap_or(0.0);
            let checkpoint = match event["event"].as_str() {
                Some("start") => (now, None),
                Some("checkpoint") => {
                    let took = Duration::from_secs_f64(seconds);
                    (now.checked_sub(took).unwrap_or(now), Some(took))
                }
                _ => continue,
            };
            if sender.send(checkpoint).is_err() {
                return;
            }
        }
    });
    receiver
}

/// What a kill cost.
struct Killed {
    loss: Duration,
    /// Whether there was a checkpoint.
    has_checkpoint: bool,
    longest_write: Duration,
}

/// Kills a render at some moment; `None` if it ended before.
fn kill_after(
    child: &mut Child,
    moment: Moment,
    checkpoints: &Receiver<Checkpoint>,
) -> Option<Killed> {
    let Ok((started, _)) = checkpoints.recv() else {
        assert!(child.wait().unwrap().success(), "a render has failed");
        return None;
    };
    let mut last = (started, None);
    let mut longest_write = Duration::ZERO;
    let time = match moment {
        Moment::AfterStart(time) => time,
        Moment::AfterCheckpoint(time) => {
            // A render that ends before its first checkpoint is noticed below.
            last = checkpoints.recv().unwrap_or(last);
            time
        }
    };
    thread::sleep(time.saturating_sub(last.0.elapsed()));
    if let Some(status) = child.try_wait().unwrap() {
        assert!(status.success(), "a render has failed");
        return None;
    }
    child.kill().unwrap();
    let killed = Instant::now();
    child.wait().unwrap();
    loop {
        match checkpoints.recv_timeout(Duration::from_secs(10)) {
            Ok(checkpoint) => {
                last = checkpoint;
                longest_write = longest_write.max(checkpoint.1.unwrap_or_default());
            }
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) => panic!("a killed render holds its output open"),
        }
    }
    let loss = killed.saturating_duration_since(last.0);
    Some(Killed { loss, has_checkpoint: last.1.is_some(), longest_write })
}

impl Tally {
    fn add(&mut self, killed: &Killed, interval: Duration) {
        self.kills += 1;
        self.before_the_first += u64::from(!killed.has_checkpoint);
        self.longest_loss = self.longest_loss.max(killed.loss);
        self.longest_write = self.longest_write.max(killed.longest_write);
        self.excesses.push(killed.loss.saturating_sub(interval));
    }
}

/// A render of a case to a file.
fn render(case: &Case, path: &Path, more: &[&str]) -> Command {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut render = Command::new(binary());
    render.arg("render").arg(scenes.join(case.scene).join("scene.xml"));
    render.arg("--quiet").arg("--output").arg(path);
    render.args(case.options).args(more).stdin(Stdio::null());
    render
}
