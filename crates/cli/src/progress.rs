//! Shows the progress of a render: a bar on a terminal, plain lines elsewhere.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use etendue::{Cancel, Observer, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use crate::failure::Status;
use crate::{style, terminal, text};

/// The bar's length; finer steps would not be visible.
const STEPS: u64 = 1000;

/// The shortest and the longest interval between plain lines.
const LINE_INTERVALS: [Duration; 2] = [Duration::from_secs(2), Duration::from_secs(60)];

/// The interval between lines of JSON.
const JSON_INTERVAL: Duration = Duration::from_secs(1);

/// Shows progress in one of four ways.
pub(crate) struct ProgressDisplay {
    way: Way,
    /// Whether the render is asked to stop.
    cancel: Cancel,
    /// Whether other programs could not be told.
    has_failed: AtomicBool,
}

/// The ways to show progress.
enum Way {
    /// A bar. The engine's progress reports redraw it; it has no thread of its own.
    Bar(ProgressBar),
    /// Plain lines, and the time at which the next one is due.
    Lines(Mutex<Duration>),
    /// Lines of JSON on standard output, and the time at which the next one is due.
    Json(Mutex<Duration>),
    /// Nothing.
    Silent,
}

impl ProgressDisplay {
    /// Chooses the display for a mode.
    pub(crate) fn new(mode: ProgressMode, cancel: &Cancel) -> Self {
        let way = match mode {
            ProgressMode::Json => Way::Json(Mutex::new(Duration::ZERO)),
            ProgressMode::Silent => Way::Silent,
            ProgressMode::Default if style::is_moving() => Way::Bar(bar()),
            ProgressMode::Default => Way::Lines(Mutex::new(LINE_INTERVALS[0])),
        };
        Self { way, cancel: cancel.clone(), has_failed: AtomicBool::new(false) }
    }

    /// Whether other programs could be told everything.
    pub(crate) fn status(&self) -> Status {
        if self.has_failed.load(Ordering::Relaxed) { Status::Failed } else { Status::Success }
    }

    /// Prints a warning without disturbing the bar.
    pub(crate) fn warn(&self, message: &str) {
        match &self.way {
            Way::Bar(bar) => bar.suspend(|| terminal::warning(message)),
            _ => terminal::warning(message),
        }
    }

    /// Reports a checkpoint to other programs. `age` is the time since its samples were taken.
    pub(crate) fn checkpoint(&self, path: &Path, age: Duration) {
        let (file, seconds) = (path.display().to_string(), age.as_secs_f64());
        self.event("checkpoint", &json!({ "file": file, "seconds": seconds }));
    }

    /// Reports an event to other programs.
    pub(crate) fn event(&self, name: &str, details: &Value) {
        if let Way::Json(_) = &self.way {
            let mut line = json!({ "event": name });
            if let (Some(line), Some(details)) = (line.as_object_mut(), details.as_object()) {
                line.extend(details.clone());
            }
            // The picture is still worth rendering.
            if let Err(failure) = terminal::json_line(&line)
                && !self.has_failed.swap(true, Ordering::Relaxed)
            {
                terminal::error(&failure.message);
            }
        }
    }

    /// Removes the bar, so that the next message starts on a clean line.
    pub(crate) fn finish(&self) {
        if let Way::Bar(bar) = &self.way {
            bar.finish_and_clear();
        }
    }
}

/// The kind of progress display requested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ProgressMode {
    /// A bar or plain lines, depending on standard error.
    Default,
    /// One line of JSON per second on standard output.
    Json,
    /// Nothing.
    Silent,
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
    let template = ProgressStyle::with_template("{wide_bar} {msg}");
    let look = template.unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.set_style(if style::is_ascii() { look.progress_chars("##.") } else { look });
    bar
}

impl Observer for ProgressDisplay {
    fn progress(&self, progress: &Progress) {
        match &self.way {
            // After Ctrl-C the bar goes, so that whatever comes next starts on a clean line.
            Way::Bar(bar) if self.cancel.is_cancelled() => bar.finish_and_clear(),
            Way::Bar(bar) => {
                // Each of the two draws, and the first line should have its text.
                bar.set_message(describe(progress));
                bar.set_position((progress.fraction() * STEPS as f64) as u64);
            }
            Way::Lines(next) => {
                // A time is valid even if the lock is poisoned.
                let mut next = next.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                if progress.elapsed >= *next {
                    *next = progress.elapsed + line_interval(progress.elapsed);
                    terminal::message_line(&describe(progress));
                }
            }
            Way::Json(next) => {
                let mut next = next.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                if progress.elapsed >= *next || progress.fraction() >= 1.0 {
                    *next = progress.elapsed + JSON_INTERVAL;
                    self.event("progress", &as_json(progress));
                }
            }
            Way::Silent => {}
        }
    }
}

fn as_json(progress: &Progress) -> Value {
    json!({
        "samples_done": progress.samples_done,
        "samples_total": progress.samples_total,
        "fraction": progress.fraction(),
        "samples_per_second": progress.rate(),
        "seconds": progress.elapsed.as_secs_f64(),
        "seconds_left": progress.time_left().map(|left| left.as_secs_f64()),
    })
}

/// The interval grows with the elapsed time, so that logs stay short.
fn line_interval(elapsed: Duration) -> Duration {
    (elapsed / 8).clamp(LINE_INTERVALS[0], LINE_INTERVALS[1])
}

/// ` 25.0 %  2.00 M of 8.00 M, 500 ksamples/s, 4.00 s gone, 12 s left`.
fn describe(progress: &Progress) -> String {
    let percent = progress.fraction() * 100.0;
    let scaled = |count: u64| text::scaled(count as f64).trim_end().to_owned();
    let total = progress.samples_total.map(|total| format!(" of {}", scaled(total)));
    let done = scaled(progress.samples_done) + &total.unwrap_or_default();
    let rate = text::scaled(progress.rate());
    let gone = text::duration(progress.elapsed);
    let left = progress.time_left().map(|left| format!(", {} left", text::duration(left)));
    let left = left.unwrap_or_default();
    format!("{percent:5.1} %  {done}, {rate}samples/s, {gone} gone{left}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_description_has_samples_rate_and_times() {
        let progress = Progress {
            samples_done: 2_000_000,
            samples_before: 0,
            samples_total: Some(8_000_000),
            elapsed: Duration::from_secs(4),
            time_limit: None,
        };
        assert_eq!(
            describe(&progress),
            " 25.0 %  2.00 M of 8.00 M, 500 ksamples/s, 4.00 s gone, 12 s left"
        );
        let timed =
            Progress { samples_total: None, time_limit: Some(Duration::from_secs(6)), ..progress };
        assert_eq!(describe(&timed), " 66.7 %  2.00 M, 500 ksamples/s, 4.00 s gone, 2.00 s left");
    }

    #[test]
    fn the_interval_between_lines_grows() {
        assert_eq!(line_interval(Duration::ZERO), LINE_INTERVALS[0]);
        assert_eq!(line_interval(Duration::from_secs(80)), Duration::from_secs(10));
        assert_eq!(line_interval(Duration::from_secs(10_000)), LINE_INTERVALS[1]);
    }
}
