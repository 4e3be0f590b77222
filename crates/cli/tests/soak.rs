//! A long render must take constant memory.
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

/// How long to render; the environment variable `ETENDUE_SOAK_MINUTES` overrides it.
const MINUTES: f64 = 2.0;

/// The interval between checkpoints and between previews.
const INTERVAL: &str = "2s";

/// The interval between measurements of the memory.
const SAMPLING_INTERVAL: Duration = Duration::from_millis(500);

/// The relative difference allowed between the peaks at the start and at the end.
const TOLERANCE: f64 = 0.05;

/// Renders with checkpoints and previews. Compares the peak resident set of the first quarter of
/// the time (at most a minute) with that of an equally long period at the end.
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
    let measurements = watch(&mut render.spawn().unwrap());

    let end = measurements.last().expect("the render was too short to measure").0;
    let part = (end / 4).min(Duration::from_secs(60));
    let peak = |is_within: &dyn Fn(Duration) -> bool| {
        let within = measurements.iter().filter(|(time, _)| is_within(*time));
        within.map(|(_, memory)| *memory).fold(0.0, f64::max)
    };
    let first = peak(&|time| time <= part);
    // Encoding the finished picture takes extra memory, so the very end is left out.
    let margin = SAMPLING_INTERVAL * 4;
    let last = peak(&|time| time + part + margin >= end && time + margin < end);
    let change = last / first - 1.0;
    println!("{first:.1} MiB at the start, {last:.1} MiB at the end, {:+.2} %", 100.0 * change);
    assert!(change.abs() <= TOLERANCE, "{first:.1} MiB at the start, {last:.1} MiB at the end");
}

/// Measures the resident set in MiB until the render ends; returns each time and value.
fn watch(child: &mut Child) -> Vec<(Duration, f64)> {
    let started = Instant::now();
    let mut measurements = Vec::new();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "the render failed");
            return measurements;
        }
        if let Some(memory) = resident_set(child.id()) {
            measurements.push((started.elapsed(), memory));
        }
        sleep(SAMPLING_INTERVAL);
    }
}

fn resident_set(process: u32) -> Option<f64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes / 1024.0)
}
