//! Ctrl-C, SIGTERM and SIGHUP: the first signal stops the render and saves its results, the second one ends
//! the process at once.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use etendue::Cancel;
#[cfg(unix)]
use signal_hook::consts::SIGHUP;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::failure::Signal;

const SIGNALS: &[(i32, Signal)] = &[
    (SIGINT, Signal::Interrupt),
    (SIGTERM, Signal::Terminate),
    #[cfg(unix)]
    (SIGHUP, Signal::HangUp),
];

/// The state that the signal handlers set.
pub(crate) struct Signals {
    cancel: Cancel,
    /// Whether the next signal ends the process from its handler.
    leave_at_once: Arc<AtomicBool>,
    /// The exit code of the last signal; 0 before any.
    received: Arc<AtomicUsize>,
}

impl Signals {
    /// Installs the handlers. Until [`Signals::finish_gracefully`], a signal ends the process at
    /// once, because there is nothing to save yet.
    pub(crate) fn install() -> io::Result<Self> {
        let signals = Self {
            cancel: Cancel::new(),
            leave_at_once: Arc::new(AtomicBool::new(true)),
            received: Arc::default(),
        };
        for &(number, signal) in SIGNALS {
            if signal == Signal::HangUp && is_hang_up_ignored() {
                continue;
            }
            // Handlers run in this order: the first signal during a render sets the flag that makes
            // the second one end the process.
            let leave = Arc::clone(&signals.leave_at_once);
            flag::register_conditional_shutdown(number, i32::from(signal.code()), leave)?;
            flag::register(number, Arc::clone(&signals.leave_at_once))?;
            flag::register(number, signals.cancel.flag())?;
            let code = usize::from(signal.code());
            flag::register_usize(number, Arc::clone(&signals.received), code)?;
        }
        Ok(signals)
    }

    /// Lets the next signal stop the render gracefully, because there is a picture to save.
    pub(crate) fn finish_gracefully(&self) {
        self.leave_at_once.store(false, Ordering::SeqCst);
    }

    /// Lets the next signal end the process at once, because there is nothing to save.
    pub(crate) fn leave_at_once(&self) {
        self.leave_at_once.store(true, Ordering::SeqCst);
    }

    /// The flag that stops the render.
    pub(crate) fn cancel(&self) -> &Cancel {
        &self.cancel
    }

    /// The last signal received.
    pub(crate) fn received(&self) -> Option<Signal> {
        let code = self.received.load(Ordering::SeqCst);
        let mut signals = SIGNALS.iter().map(|(_, signal)| *signal);
        signals.find(|signal| usize::from(signal.code()) == code)
    }
}

/// Whether SIGHUP is ignored, as `nohup` asks for. Other systems than Linux do not tell.
fn is_hang_up_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    is_first_signal_ignored(&status)
}

/// Whether the mask in the line `SigIgn: 0000000000001001` has the bit of signal 1.
fn is_first_signal_ignored(status: &str) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).is_ok_and(|mask| mask & 1 == 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mask_of_ignored_signals_is_read() {
        assert!(is_first_signal_ignored("Name:\tx\nSigIgn:\t0000000000001001\n"));
        assert!(!is_first_signal_ignored("SigIgn:\t0000000000001000\nSigCgt:\t0000000000000001\n"));
        assert!(!is_first_signal_ignored(""));
    }
}
