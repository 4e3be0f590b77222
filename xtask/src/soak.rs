//! `cargo xtask soak [MINUTES] [SCENE]`: a long render at constant memory.

use std::fs;
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::etendue::{build, command, folder};
use crate::workspace::root;

/// How long it takes, unless the arguments say otherwise.
const MINUTES: u64 = 60;

/// What is rendered, unless the arguments say otherwise.
const SCENE: &str = "scenes/textures/scene.xml";

/// Between two looks at the memory.
const LOOK: Duration = Duration::from_secs(2);

/// The memory of the last minute may differ from that of the first one by this part of it.
const TOLERANCE: f64 = 0.05;

/// Renders with a checkpoint and a preview every ten seconds, and compares the greatest resident set
/// of the first minute with that of the last one.
pub(crate) fn run(arguments: &[String]) -> bool {
    let minutes = arguments.first().and_then(|text| text.parse().ok()).unwrap_or(MINUTES);
    let scene = arguments.get(1).map_or(SCENE, String::as_str);
    match build().then(|| soak(minutes, scene)) {
        Some(Ok([first, last])) => {
            let change = last / first - 1.0;
            println!(
                "{minutes} minutes: {first:.1} MiB in the first, {last:.1} MiB in the last, \
                 {:+.2} %",
                change * 100.0
            );
            change.abs() <= TOLERANCE
        }
        Some(Err(problem)) => {
            eprintln!("error: {problem}");
            false
        }
        None => false,
    }
}

/// The greatest resident sets of the first and of the last minute, in MiB.
fn soak(minutes: u64, scene: &str) -> Result<[f64; 2], String> {
    let folder = folder("soak")?;
    let mut render = command();
    render.arg("render").arg(root().join(scene)).arg("--resume=never");
    render.arg("--time").arg(format!("{minutes}m")).arg("--output").arg(folder.join("soak.exr"));
    render.args(["--checkpoint-every", "10s", "--preview-every", "10s", "--threads", "1"]);
    render.arg("--preview").arg(folder.join("preview.png"));
    let child = render.arg("--quiet").stdin(Stdio::null()).spawn();
    let mut child = child.map_err(|error| error.to_string())?;
    let looks = watch(&mut child)?;
    let end = looks.last().map_or(Duration::ZERO, |(time, _)| *time);
    let minute = Duration::from_secs(60);
    let greatest = |is_within: &dyn Fn(Duration) -> bool| {
        let within = looks.iter().filter(|(time, _)| is_within(*time));
        within.map(|(_, memory)| *memory).fold(0.0, f64::max)
    };
    Ok([
        greatest(&|time| time <= minute),
        // The end has to be left out: the finished picture is encoded in it.
        greatest(&|time| time + minute + LOOK >= end && time + LOOK < end),
    ])
}

/// The resident set in MiB at every look, until the render is done.
fn watch(child: &mut Child) -> Result<Vec<(Duration, f64)>, String> {
    let started = Instant::now();
    let mut looks = Vec::new();
    loop {
        if let Some(status) = child.try_wait().map_err(|error| error.to_string())? {
            return if status.success() { Ok(looks) } else { Err("the render failed".to_owned()) };
        }
        if let Some(memory) = resident_set(child.id()) {
            looks.push((started.elapsed(), memory));
        }
        sleep(LOOK);
    }
}

/// Linux alone tells.
fn resident_set(process: u32) -> Option<f64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes / 1024.0)
}
