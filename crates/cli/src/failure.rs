//! How a run ends: exit codes and error messages.

use std::fmt::Display;

/// How a run ends, worst last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Status {
    Success,
    /// Rendering or writing failed.
    Failed,
    /// The arguments or the input are wrong.
    BadInput,
    /// A signal stopped the run; finished work was saved.
    Stopped(Signal),
}

/// A signal that asks for an early end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Signal {
    /// SIGHUP: the terminal has been closed.
    HangUp,
    /// Ctrl-C.
    Interrupt,
    /// SIGTERM, which `kill` sends.
    Terminate,
}

impl Signal {
    /// The exit code that shells report: 128 plus the signal's number.
    pub(crate) const fn code(self) -> u8 {
        match self {
            Self::HangUp => 129,
            Self::Interrupt => 130,
            Self::Terminate => 143,
        }
    }
}

impl Status {
    /// The exit code, as `--help` lists it.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Success => 0,
            Self::Failed => 1,
            Self::BadInput => 2,
            Self::Stopped(signal) => signal.code(),
        }
    }
}

/// An error that ends the run.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) status: Status,
    /// What went wrong, without a full stop.
    pub(crate) message: String,
}

impl Failure {
    /// An error in the arguments or an input file.
    pub(crate) fn bad_input(message: impl Display) -> Self {
        Self { status: Status::BadInput, message: message.to_string() }
    }

    /// Any other error, such as a full disk.
    pub(crate) fn failed(message: impl Display) -> Self {
        Self { status: Status::Failed, message: message.to_string() }
    }
}
