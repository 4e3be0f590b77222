//! `cargo xtask kill [COUNT] [SEED]`: renders killed with SIGKILL at random moments, resumed until
//! they are done, and compared with an undisturbed render: every bit must be equal, and no kill may
//! cost more than the interval between checkpoints and the time that writing one takes.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;
use std::time::{Duration, Instant};

use etendue_testkit::TestRng;
use serde_json::Value;

use crate::etendue::{build, command, folder};
use crate::workspace::root;

/// Renders that are killed, unless the arguments say otherwise.
const COUNT: u64 = 100;

/// What a busy machine may put between a moment and its being noticed.
const NOTICING: Duration = Duration::from_millis(50);

/// Intervals between checkpoints, in milliseconds. With the short ones, something is being written
/// at nearly every moment.
const INTERVALS: [u64; 4] = [5, 20, 100, 300];

/// One kind of render.
struct Case {
    scene: &'static str,
    options: &'static [&'static str],
}

/// Renders of some seconds on one thread, of all that sums may hold.
const CASES: [Case; 3] = [
    Case { scene: "scenes/cornell-box/scene.xml", options: &["--size", "96x96", "--spp", "96"] },
    Case {
        scene: "scenes/glass-and-metal/scene.xml",
        options: &["--size", "100x60", "--spp", "64", "--variance"],
    },
    Case {
        scene: "scenes/soft-shadows/scene.xml",
        options: &["--size", "90x50", "--spp", "80", "--filter", "lanczos"],
    },
];

/// What all kills together showed.
#[derive(Default)]
struct Tally {
    kills: u64,
    /// Kills in the middle of a write, by what it left.
    during_writes: u64,
    before_the_first: u64,
    longest_loss: Duration,
    longest_write: Duration,
    /// How far the longest loss went beyond its interval.
    longest_excess: Duration,
}

/// Runs the test; says what it showed.
pub(crate) fn run(arguments: &[String]) -> bool {
    let number = |index: usize| arguments.get(index).and_then(|text| text.parse().ok());
    let (count, seed) = (number(0).unwrap_or(COUNT), number(1).unwrap_or(1));
    let mut tally = Tally::default();
    match build().then(|| kill_all(count, seed, &mut tally)) {
        Some(Ok(())) => {
            println!(
                "{count} renders, {} kills: all pictures equal, bit for bit\n\
                 {} kills while a checkpoint was written, {} before the first one\n\
                 longest loss {:.0} ms; beyond its interval {:.0} ms; longest write {:.0} ms",
                tally.kills,
                tally.during_writes,
                tally.before_the_first,
                milliseconds(tally.longest_loss),
                milliseconds(tally.longest_excess),
                milliseconds(tally.longest_write),
            );
            true
        }
        Some(Err(problem)) => {
            eprintln!("error: {problem}");
            false
        }
        None => false,
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

fn kill_all(count: u64, seed: u64, tally: &mut Tally) -> Result<(), String> {
    let folder = folder("kill")?;
    let mut expected = Vec::new();
    for (index, case) in CASES.iter().enumerate() {
        let path = folder.join(format!("whole{index}.pfm"));
        render(case, &path, &[]).status().map_err(text)?;
        expected.push(fs::read(&path).map_err(text)?);
    }
    let mut random = TestRng::new(seed);
    for round in 0..count {
        let index = (round % CASES.len() as u64) as usize;
        let path = folder.join("killed.pfm");
        remove_all(&folder, "killed.pfm")?;
        kill_one(&CASES[index], &path, &mut random, tally)?;
        if fs::read(&path).map_err(text)? != expected[index] {
            return Err(format!("render {round} of {} is another picture", CASES[index].scene));
        }
        let left = names(&folder, "killed.pfm")?;
        if left != ["killed.pfm"] {
            return Err(format!("render {round} has left {left:?}"));
        }
    }
    // No kill may cost more than the interval and a write, of which no more is known than that some
    // other one took as long.
    if tally.longest_excess > tally.longest_write + NOTICING {
        let excess = milliseconds(tally.longest_excess);
        return Err(format!("a kill cost {excess:.0} ms more than its interval"));
    }
    Ok(())
}

/// Kills one render up to five times, then lets it finish.
fn kill_one(
    case: &Case,
    path: &Path,
    random: &mut TestRng,
    tally: &mut Tally,
) -> Result<(), String> {
    for _ in 0..=random.next_u32() % 5 {
        let interval = Duration::from_millis(INTERVALS[random.next_u32() as usize % 4]);
        let every = format!("{}ms", interval.as_millis());
        let threads = (1 + random.next_u32() % 3).to_string();
        let more = ["--checkpoint-every", &every, "-t", &threads, "--json-progress"];
        let mut command = render(case, path, &more);
        let mut child = command.stdout(Stdio::piped()).spawn().map_err(text)?;
        let checkpoints = listen(&mut child)?;
        let time = interval.mul_f32(4.0 * random.next_f32()) + interval / 4;
        let moment = match random.next_u32() % 4 {
            0 => Moment::AfterStart(time),
            _ => Moment::AfterCheckpoint(time),
        };
        if !kill_after(&mut child, moment, &checkpoints, (interval, tally))? {
            return Ok(());
        }
        let during_write = names(path.parent().unwrap_or(path), ".killed.pfm.checkpoint")?;
        tally.during_writes += u64::from(!during_write.is_empty());
    }
    let status = render(case, path, &[]).status().map_err(text)?;
    if status.success() { Ok(()) } else { Err("a render cannot be resumed".to_owned()) }
}

/// When a render is killed.
#[derive(Clone, Copy, Debug)]
enum Moment {
    /// So long after its start, with or without something to go on with.
    AfterStart(Duration),
    /// So long after its first checkpoint.
    AfterCheckpoint(Duration),
}

/// A checkpoint: when its writing began and how long it took. `None` for the start of rendering.
type Kept = (Instant, Option<Duration>);

/// Hears when rendering starts and checkpoints are written.
fn listen(child: &mut Child) -> Result<Receiver<Kept>, String> {
    let output = child.stdout.take().ok_or("no output to listen to")?;
    let (sender, receiver) = channel();
    thread::spawn(move || {
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            let now = Instant::now();
            let event: Value = serde_json::from_str(&line).unwrap_or_default();
            let seconds = event["seconds"].as_f64().unwrap_or(0.0);
            let kept = match event["event"].as_str() {
                Some("start") => (now, None),
                Some("checkpoint") => {
                    let took = Duration::from_secs_f64(seconds);
                    (now.checked_sub(took).unwrap_or(now), Some(took))
                }
                _ => continue,
            };
            if sender.send(kept).is_err() {
                return;
            }
        }
    });
    Ok(receiver)
}

/// Kills a render at some moment, and counts what that cost. Returns whether it was
/// killed before its end.
fn kill_after(
    child: &mut Child,
    moment: Moment,
    checkpoints: &Receiver<Kept>,
    (interval, tally): (Duration, &mut Tally),
) -> Result<bool, String> {
    let Ok((started, _)) = checkpoints.recv() else {
        return if child.wait().map_err(text)?.success() {
            Ok(false)
        } else {
            Err("a render has failed".to_owned())
        };
    };
    let mut last = (started, None);
    let time = match moment {
        Moment::AfterStart(time) => time,
        Moment::AfterCheckpoint(time) => {
            // A render that ends before its first checkpoint is noticed below.
            last = checkpoints.recv().unwrap_or(last);
            time
        }
    };
    thread::sleep(time.saturating_sub(last.0.elapsed()));
    if let Some(status) = child.try_wait().map_err(text)? {
        return if status.success() { Ok(false) } else { Err("a render has failed".to_owned()) };
    }
    child.kill().map_err(text)?;
    let killed = Instant::now();
    child.wait().map_err(text)?;
    // A render that had come to its end has removed its checkpoint; nothing is lost then.
    loop {
        match checkpoints.recv_timeout(Duration::from_secs(10)) {
            Ok(kept) => {
                last = kept;
                tally.longest_write = tally.longest_write.max(kept.1.unwrap_or_default());
            }
            Err(_) if checkpoints.try_recv() == Err(TryRecvError::Disconnected) => break,
            Err(error) => return Err(error.to_string()),
        }
    }
    tally.kills += 1;
    tally.before_the_first += u64::from(last.1.is_none());
    let loss = killed.saturating_duration_since(last.0);
    tally.longest_loss = tally.longest_loss.max(loss);
    tally.longest_excess = tally.longest_excess.max(loss.saturating_sub(interval));
    Ok(true)
}

/// A render that goes on with what there is.
fn render(case: &Case, path: &Path, more: &[&str]) -> std::process::Command {
    let mut render = command();
    render.arg("render").arg(root().join(case.scene)).arg("--quiet").arg("--output").arg(path);
    render.args(case.options).arg("--resume=auto").args(more).stdin(Stdio::null());
    render
}

/// The files whose names begin so, sorted.
fn names(folder: &Path, start: &str) -> Result<Vec<String>, String> {
    let entries = fs::read_dir(folder).map_err(text)?;
    let names = entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|name| name.starts_with(start)).collect();
    names.sort();
    Ok(names)
}

fn remove_all(folder: &Path, name: &str) -> Result<(), String> {
    for start in [name.to_owned(), format!(".{name}")] {
        let paths: Vec<PathBuf> = names(folder, &start)?.iter().map(|n| folder.join(n)).collect();
        for path in paths {
            fs::remove_file(path).map_err(text)?;
        }
    }
    Ok(())
}

fn text(error: std::io::Error) -> String {
    error.to_string()
}
