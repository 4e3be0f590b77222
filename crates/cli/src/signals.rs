//! Ctrl-C and SIGTERM: the first one ends the render and writes what is done, the second one
//! leaves at once.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use etendue::Cancel;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::failure::Signal;

const SIGNALS: [(i32, Signal); 2] = [(SIGINT, Signal::Interrupt), (SIGTERM, Signal::Terminate)];

/// What the signals set.
pub(crate) struct Signals {
    cancel: Cancel,
    /// Whether the next signal ends the process within its handler.
    leave_at_once: Arc<AtomicBool>,
    /// The exit code of the signal that came last; 0 before any.
    received: Arc<AtomicUsize>,
}

impl Signals {
    /// Takes the signals over. Until [`Signals::finish_gracefully`], they end the process at once:
    /// there is nothing yet that would be worth writing.
    pub(crate) fn install() -> io::Result<Self> {
        let signals = Self {
            cancel: Cancel::new(),
            leave_at_once: Arc::new(AtomicBool::new(true)),
            received: Arc::default(),
        };
        for (number, signal) in SIGNALS {
            // Handlers run in this order, so the first signal of a render arms the way out that
            // the second one takes.
            let leave = Arc::clone(&signals.leave_at_once);
            flag::register_conditional_shutdown(number, i32::from(signal.code()), leave)?;
            flag::register(number, Arc::clone(&signals.leave_at_once))?;
            flag::register(number, signals.cancel.flag())?;
            let code = usize::from(signal.code());
            flag::register_usize(number, Arc::clone(&signals.received), code)?;
        }
        Ok(signals)
    }

    /// From here on there is a picture to save.
    pub(crate) fn finish_gracefully(&self) {
        self.leave_at_once.store(false, Ordering::SeqCst);
    }

    /// From here on there is none: the next signal ends the process.
    pub(crate) fn leave_at_once(&self) {
        self.leave_at_once.store(true, Ordering::SeqCst);
    }

    /// What stops the render.
    pub(crate) fn cancel(&self) -> &Cancel {
        &self.cancel
    }

    /// The signal that came last.
    pub(crate) fn received(&self) -> Option<Signal> {
        let code = self.received.load(Ordering::SeqCst);
        let signals = SIGNALS.map(|(_, signal)| signal);
        signals.into_iter().find(|signal| usize::from(signal.code()) == code)
    }
}
