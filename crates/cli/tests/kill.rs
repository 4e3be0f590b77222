//! Kills renders with SIGKILL at random moments and resumes them until they finish. Each picture must
//! equal that of an uninterrupted render, bit for bit. A kill may lose no more than the interval
//! between checkpoints and the time to write one.
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

/// The delay that a busy machine may add to a measured loss: for nine kills in ten, and for any kill.
const USUAL_DELAY: Duration = Duration::from_millis(50);
const LONGEST_DELAY: Duration = Duration::from_secs(2);

/// Intervals between checkpoints, in milliseconds. With the short ones, a checkpoint is being written
/// nearly all the time.
const INTERVALS: [u64; 4] = [5, 20, 100, 300];

/// The name of the picture.
const PICTURE: &str = "killed.pfm";

/// A scene and its options.
struct Case {
    scene: &'static str,
    options: &'static [&'static str],
}

/// Renders that take a few seconds on one thread. Together they cover all contents of a checkpoint.
const CASES: [Case; 3] = [
    Case { scene: "cornell-box", options: &["--size", "96x96", "--spp", "96"] },
    Case { scene: "glass-and-metal", options: &["--size", "100x60", "--spp", "64", "--variance"] },
    Case {
        scene: "soft-shadows",
        options: &["--size", "90x50", "--spp", "80", "--filter", "lanczos"],
    },
];

/// Results over all kills.
#[derive(Debug, Default)]
struct Tally {
    kills: u64,
    /// Kills during a write, recognised by the temporary file left behind.
    during_writes: u64,
    before_the_first: u64,
    longest_loss: Duration,
    longest_write: Duration,
    /// How much each loss exceeded the interval.
    excesses: Vec<Duration>,
}

#[test]
#[ignore = "slow; `cargo test -- --include-ignored` runs it, ETENDUE_KILLS sets the number of renders"]
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
        assert_eq!(workplace.files(), [PICTURE], "render {round} of {scene} left files behind");
        let is_equal = workplace.read(PICTURE) == expected[index];
        assert!(is_equal, "render {round} of {scene} gave another picture");
        fs::remove_file(workplace.path(PICTURE)).unwrap();
    }
    tally.excesses.sort();
    println!("{count} renders, all pictures equal; {tally:?}");
    assert!(tally.kills >= count / 2, "most renders ended before they were killed");
    // A kill loses at most the interval and one write. The duration of an unfinished write is unknown,
    // so the longest finished one stands in for it.
    let usual = tally.excesses[tally.excesses.len() * 9 / 10];
    let longest = tally.excesses[tally.excesses.len() - 1];
    assert!(usual <= tally.longest_write + USUAL_DELAY, "a tenth of the kills lost {usual:?} more");
    assert!(longest <= tally.longest_write + LONGEST_DELAY, "a kill lost {longest:?} more");
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
        let unfinished = workplace.files().iter().any(|name| name.starts_with('.'));
        tally.during_writes += u64::from(unfinished);
    }
    let status = render(case, &path, &["--resume=auto"]).status().unwrap();
    assert!(status.success(), "a render cannot be resumed");
}

/// When to kill a render.
#[derive(Clone, Copy, Debug)]
enum Moment {
    /// This long after its start, whether or not it has written a checkpoint.
    AfterStart(Duration),
    /// This long after its first checkpoint.
    AfterCheckpoint(Duration),
}

/// When writing a checkpoint began and how long it took; `None` for the start of rendering.
type Checkpoint = (Instant, Option<Duration>);

/// Receives the start of rendering and the checkpoints from the render's output.
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

/// The effect of a kill.
struct Killed {
    loss: Duration,
    /// Whether the render had written a checkpoint.
    has_checkpoint: bool,
    longest_write: Duration,
}

/// Kills a render at some moment; `None` if it had already ended.
fn kill_after(
    child: &mut Child,
    moment: Moment,
    checkpoints: &Receiver<Checkpoint>,
) -> Option<Killed> {
    let Ok((started, _)) = checkpoints.recv() else {
        assert!(child.wait().unwrap().success(), "a render failed");
        return None;
    };
    let mut last = (started, None);
    let mut longest_write = Duration::ZERO;
    let time = match moment {
        Moment::AfterStart(time) => time,
        Moment::AfterCheckpoint(time) => {
            // The check below detects a render that ends before its first checkpoint.
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
            Err(RecvTimeoutError::Timeout) => panic!("a killed render keeps its output open"),
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
