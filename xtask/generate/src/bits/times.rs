//! Paired process times.

use std::process::Command;
use std::time::Instant;

use crate::test_scenes::succeed;

/// The time of a process in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Times {
    /// Wall time.
    wall: f64,
    /// Processor time of all its threads, user and system; NaN if the system does not report it.
    processor: f64,
}

/// The times of the two commands for the same scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) before: Times,
    pub(super) after: Times,
}

/// Runs a command and waits for it.
///
/// # Errors
/// Its standard error, if it fails.
pub(super) fn measure(command: &mut Command) -> Result<Times, String> {
    let (started, earlier) = (Instant::now(), processor_seconds_of_children());
    succeed(command)?;
    let processor = processor_seconds_of_children() - earlier;
    Ok(Times { wall: started.elapsed().as_secs_f64(), processor })
}

/// The processor time of all finished child processes.
#[cfg(unix)]
fn processor_seconds_of_children() -> f64 {
    use nix::sys::resource::{UsageWho, getrusage};
    let Ok(usage) = getrusage(UsageWho::RUSAGE_CHILDREN) else { return f64::NAN };
    let seconds =
        |time: nix::sys::time::TimeVal| time.tv_sec() as f64 + time.tv_usec() as f64 * 1e-6;
    seconds(usage.user_time()) + seconds(usage.system_time())
}

#[cfg(not(unix))]
fn processor_seconds_of_children() -> f64 {
    f64::NAN
}

/// A table with, for each kind of time, the sums, their ratio, and the median ratio of all pairs.
pub(super) fn report(pairs: &[Pair]) -> String {
    let mut text = format!(
        "{:<10}{:>10}{:>10}{:>9}{:>15}\n",
        "time", "before s", "after s", "ratio", "median ratio"
    );
    type Kind = fn(&Times) -> f64;
    let (processor, wall): (Kind, Kind) = (|times| times.processor, |times| times.wall);
    for (name, kind) in [("processor", processor), ("wall", wall)] {
        let sum =
            |side: fn(&Pair) -> &Times| pairs.iter().map(|pair| kind(side(pair))).sum::<f64>();
        let (before, after) = (sum(|pair| &pair.before), sum(|pair| &pair.after));
        let ratios = pairs.iter().map(|pair| kind(&pair.after) / kind(&pair.before));
        let median = median(ratios.filter(|ratio| ratio.is_finite()).collect());
        let ratio = after / before;
        text += &format!("{name:<10}{before:>10.2}{after:>10.2}{ratio:>9.3}{median:>15.3}\n");
    }
    text
}

/// The median, the upper of two middle values; NaN if there are no numbers.
fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_has_sums_and_the_median_of_ratios() {
        let times = |seconds| Times { wall: seconds, processor: 2.0 * seconds };
        let pair = |before, after| Pair { before: times(before), after: times(after) };
        let text = report(&[pair(1.0, 1.0), pair(2.0, 2.2), pair(1.0, 3.0)]);
        let row = |name: &str| {
            let line = text.lines().find(|line| line.starts_with(name)).unwrap();
            line.split_whitespace().skip(1).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(row("processor"), ["8.00", "12.40", "1.550", "1.100"]);
        assert_eq!(row("wall"), ["4.00", "6.20", "1.550", "1.100"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_process_that_works_takes_processor_time() {
        let script = "i=0; while [ $i -lt 20000 ]; do i=$((i + 1)); done";
        let times = measure(Command::new("sh").args(["-c", script])).unwrap();
        assert!(times.processor > 0.0 && times.wall > 0.0, "{times:?}");
        assert!(measure(Command::new("sh").args(["-c", "exit 3"])).is_err());
    }
}
