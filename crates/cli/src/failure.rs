//! How a run ends: exit codes, and errors with a message.

use std::fmt::Display;

/// How a run ends, worst last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Status {
    /// Everything was done.
    Fine,
    /// It failed while rendering or writing.
    Failed,
    /// The arguments or the input are wrong.
    BadInput,
    /// A signal stopped it; what was done has been written.
    Stopped(Signal),
}

/// A signal that asks for an early end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Signal {
    /// Ctrl-C.
    Interrupt,
    /// What `kill` sends.
    Terminate,
}

impl Signal {
    /// 128 and the signal's number, as shells report it.
    pub(crate) const fn code(self) -> u8 {
        match self {
            Self::Interrupt => 130,
            Self::Terminate => 143,
        }
    }
}

impl Status {
    /// The exit code, as `--help` lists it.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Fine => 0,
            Self::Failed => 1,
            Self::BadInput => 2,
            Self::Stopped(signal) => signal.code(),
        }
    }
}

/// An error that ends the run.
#[derive(Debug)]
pub(crate) struct Failure {
    /// How the run ends.
    pub(crate) status: Status,
    /// What went wrong, in a sentence without a full stop.
    pub(crate) message: String,
}

impl Failure {
    /// The arguments or an input file are to blame.
    pub(crate) fn bad_input(message: impl Display) -> Self {
        Self { status: Status::BadInput, message: message.to_string() }
    }

    /// Something else is, such as a full disk.
    pub(crate) fn failed(message: impl Display) -> Self {
        Self { status: Status::Failed, message: message.to_string() }
    }
}
