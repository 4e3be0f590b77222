//! `etendue render` as a separate process: its time, rate and memory.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::etendue;

/// What to render, and how.
pub(super) struct Job<'a> {
    /// The scene file.
    pub(super) scene: &'a Path,
    /// Width and height in pixels.
    pub(super) size: [u32; 2],
    /// Samples per pixel.
    pub(super) samples: u32,
    /// Threads.
    pub(super) threads: u32,
    /// The reconstruction filter, if different from the scene's.
    pub(super) filter: Option<&'a str>,
}

/// The cost of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Figures {
    /// Wall time of the process in seconds.
    pub(super) wall_seconds: f64,
    /// Seconds from the start of the process until it reported that rendering starts.
    pub(super) load_seconds: f64,
    /// The rate while rendering, without loading.
    pub(super) samples_per_second: f64,
    /// Peak memory as the system counts it, including the mapped executable. NaN if the system does
    /// not report it.
    pub(super) peak_megabytes: f64,
}

/// A running render.
pub(super) struct Running {
    child: Child,
    started: Instant,
    picture: PathBuf,
}

/// Starts a render. Its picture, called `name`, is deleted at the end.
pub(super) fn start(job: &Job<'_>, name: &str) -> Result<Running, String> {
    let picture = etendue::folder("bench")?.join(format!("{name}.pfm"));
    let [width, height] = job.size;
    let mut command = etendue::command();
    command.arg("render").arg(job.scene).args(["--quiet", "--json-progress"]);
    command.args(["--size", &format!("{width}x{height}"), "--spp", &job.samples.to_string()]);
    command.args(["--threads", &job.threads.to_string(), "--output"]).arg(&picture);
    if let Some(filter) = job.filter {
        command.args(["--filter", filter]);
    }
    command.stdin(Stdio::null()).stdout(Stdio::piped());
    let started = Instant::now();
    let child = command.spawn().map_err(|error| format!("cannot run etendue: {error}"))?;
    Ok(Running { child, started, picture })
}

impl Running {
    /// Waits for the process to end.
    pub(super) fn finish(mut self) -> Result<Figures, String> {
        let started = self.started;
        let news = self.child.stdout.take().ok_or("the render has no output")?;
        let listener = thread::spawn(move || listen(news, started));
        let status = format!("/proc/{}/status", self.child.id());
        let mut peak_megabytes = f64::NAN;
        let outcome = loop {
            // The system discards the peak with the process, so the last reading counts. (It is
            // polled because the standard library does not report a child's resource usage.)
            peak_megabytes = self::peak_megabytes(&status).unwrap_or(peak_megabytes);
            if let Some(outcome) = self.child.try_wait().map_err(|error| error.to_string())? {
                break outcome;
            }
            std::thread::sleep(Duration::from_millis(5));
        };
        let wall_seconds = self.started.elapsed().as_secs_f64();
        let _ = std::fs::remove_file(&self.picture);
        let news = listener.join().map_err(|_| "the listener panicked")??;
        if !outcome.success() {
            return Err(format!("the scene does not render: {outcome}"));
        }
        let samples_per_second = rate(&news.text)
            .ok_or_else(|| format!("the render reports no rate:\n{}", news.text))?;
        let load_seconds = news.first_after.as_secs_f64();
        Ok(Figures { wall_seconds, load_seconds, samples_per_second, peak_megabytes })
    }
}

/// The events that a render has reported.
struct News {
    /// When the first line arrived, which means that rendering begins.
    first_after: Duration,
    text: String,
}

/// Reads events until the render ends.
fn listen(news: impl Read, started: Instant) -> Result<News, String> {
    let mut news = BufReader::new(news);
    let mut text = String::new();
    news.read_line(&mut text).map_err(|error| error.to_string())?;
    let first_after = started.elapsed();
    news.read_to_string(&mut text).map_err(|error| error.to_string())?;
    Ok(News { first_after, text })
}

/// The rate in the last progress line that has one.
fn rate(news: &str) -> Option<f64> {
    let rate = |line| serde_json::from_str::<Value>(line).ok()?["samples_per_second"].as_f64();
    news.lines().rev().find_map(rate)
}

/// The peak memory of a process; `None` on systems other than Linux.
fn peak_megabytes(status: &str) -> Option<f64> {
    let status = std::fs::read_to_string(status).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1.024e-3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_rate_counts() {
        let news = "{\"event\":\"start\"}\n{\"samples_per_second\":1.5}\n\
                    {\"samples_per_second\":2.5}\n{\"event\":\"end\"}\n";
        assert_eq!(rate(news), Some(2.5));
        assert_eq!(rate("{\"event\":\"start\"}\nwords\n"), None);
    }
}
