//! Shows the progress of a render: a bar on a terminal, plain lines elsewhere.

use std::io::{IsTerminal, stderr};
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use etendue::{Observer, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use crate::{terminal, text};

/// The bar's length; finer steps would not be visible.
const STEPS: u64 = 1000;

/// The shortest and the longest interval between plain lines.
const LINE_INTERVALS: [Duration; 2] = [Duration::from_secs(2), Duration::from_secs(60)];

/// The interval between lines of JSON.
const JSON_INTERVAL: Duration = Duration::from_secs(1);

/// Shows progress in one of four ways.
pub(crate) enum ProgressDisplay {
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
    pub(crate) fn new(mode: ProgressMode) -> Self {
        if mode == ProgressMode::Json {
            Self::Json(Mutex::new(Duration::ZERO))
        } else if mode == ProgressMode::Silent {
            Self::Silent
        } else if stderr().is_terminal() {
            Self::Bar(bar())
        } else {
            Self::Lines(Mutex::new(LINE_INTERVALS[0]))
        }
    }

    /// Prints a warning without disturbing the bar.
    pub(crate) fn warn(&self, message: &str) {
        match self {
            Self::Bar(bar) => bar.suspend(|| terminal::warning(message)),
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
        if let Self::Json(_) = self {
            let mut line = json!({ "event": name });
            if let (Some(line), Some(details)) = (line.as_object_mut(), details.as_object()) {
                line.extend(details.clone());
            }
            // The render continues if the reader has closed the pipe.
            let _ = terminal::result(&format!("{line}\n"));
        }
    }

    /// Removes the bar, so that the next message starts on a clean line.
    pub(crate) fn finish(&self) {
        if let Self::Bar(bar) = self {
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
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

impl Observer for ProgressDisplay {
    fn progress(&self, progress: &Progress) {
        match self {
            Self::Bar(bar) => {
                bar.set_position((progress.fraction() * STEPS as f64) as u64);
                bar.set_message(describe(progress));
            }
            Self::Lines(next) => {
                // A time is valid even if the lock is poisoned.
                let mut next = next.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                if progress.elapsed >= *next {
                    *next = progress.elapsed + line_interval(progress.elapsed);
                    let percent = progress.fraction() * 100.0;
                    terminal::message_line(&format!("{percent:5.1} %  {}", describe(progress)));
                }
            }
            Self::Json(next) => {
                let mut next = next.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                if progress.elapsed >= *next || progress.fraction() >= 1.0 {
                    *next = progress.elapsed + JSON_INTERVAL;
                    self.event("progress", &as_json(progress));
                }
            }
            Self::Silent => {}
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

fn describe(progress: &Progress) -> String {
    let rate = text::scaled(progress.rate());
    match progress.time_left() {
        Some(left) => format!("{rate}samples/s, {} left", text::duration(left)),
        None => format!("{rate}samples/s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_description_has_rate_and_time_left() {
        let progress = Progress {
            samples_done: 2_000_000,
            samples_before: 0,
            samples_total: Some(8_000_000),
            elapsed: Duration::from_secs(4),
            time_limit: None,
        };
        assert_eq!(describe(&progress), "500 ksamples/s, 12 s left");
    }

    #[test]
    fn the_interval_between_lines_grows() {
        assert_eq!(line_interval(Duration::ZERO), LINE_INTERVALS[0]);
        assert_eq!(line_interval(Duration::from_secs(80)), Duration::from_secs(10));
        assert_eq!(line_interval(Duration::from_secs(10_000)), LINE_INTERVALS[1]);
    }
}
