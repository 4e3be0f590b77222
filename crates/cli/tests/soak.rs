//! A long render at constant memory.
#![cfg(target_os = "linux")]
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "tests read files and print"
)]

#[path = "process/run.rs"]
#[allow(dead_code, reason = "shared with the process tests, which use all of it")]
mod run;

use std::fs;
use std::process::Child;
use std::thread::sleep;
use std::time::{Duration, Instant};

use run::Workplace;

/// How long it takes, unless the environment variable `ETENDUE_SOAK_MINUTES` says.
const MINUTES: f64 = 2.0;

/// Checkpoints and previews are written this often.
const INTERVAL: &str = "2s";

/// Between two looks at the memory.
const LOOK: Duration = Duration::from_millis(500);

/// The peaks of the first and the last quarter may differ by this share.
const TOLERANCE: f64 = 0.05;

/// Renders with checkpoints and previews, and compares the largest resident set of the first quarter
/// of the time (at most a minute) with that of a last part as long.
#[test]
#[ignore = "slow; `cargo test -- --include-ignored` runs it for 2 minutes or ETENDUE_SOAK_MINUTES"]
fn a_long_render_takes_constant_memory() {
    let minutes =
        std::env::var("ETENDUE_SOAK_MINUTES").map_or(MINUTES, |text| text.parse().unwrap());
    let workplace = Workplace::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/textures/scene.xml");
    let seconds = format!("{}s", 60.0 * minutes);
    let mut render = workplace.command(&["render", scene, "--quiet", "--threads", "1"]);
    render.args(["--output", "soak.exr", "--preview", "preview.png", "--time", &seconds]);
    render.args(["--checkpoint-every", INTERVAL, "--preview-every", INTERVAL]);
    let looks = watch(&mut render.spawn().unwrap());

    let end = looks.last().expect("the render took longer than a look").0;
    let part = (end / 4).min(Duration::from_secs(60));
    let peak = |is_within: &dyn Fn(Duration) -> bool| {
        let within = looks.iter().filter(|(time, _)| is_within(*time));
        within.map(|(_, memory)| *memory).fold(0.0, f64::max)
    };
    let first = peak(&|time| time <= part);
    // The very end is left out, because the finished picture is encoded then.
    let margin = LOOK * 4;
    let last = peak(&|time| time + part + margin >= end && time + margin < end);
    let change = last / first - 1.0;
    println!("{first:.1} MiB at first, {last:.1} MiB at last, {:+.2} %", 100.0 * change);
    assert!(change.abs() <= TOLERANCE, "{first:.1} MiB at first, {last:.1} MiB at last");
}

/// The resident set in MiB at every look, until the render is done.
fn watch(child: &mut Child) -> Vec<(Duration, f64)> {
    let started = Instant::now();
    let mut looks = Vec::new();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "the render failed");
            return looks;
        }
        if let Some(memory) = resident_set(child.id()) {
            looks.push((started.elapsed(), memory));
        }
        sleep(LOOK);
    }
}

fn resident_set(process: u32) -> Option<f64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes / 1024.0)
}
