//! Prints messages to standard error and results to standard output.
//!
//! A closed pipe is not an error: `etendue info scene.xml | head -1` must not complain.

use std::io::{ErrorKind, Write, stderr, stdout};

use crate::color;
use crate::failure::Failure;

/// Prints an error.
pub(crate) fn error(message: &str) {
    let (start, end) = if color::is_wanted() { ("\x1b[1;31m", "\x1b[0m") } else { ("", "") };
    message_line(&format!("{start}error{end}: {message}"));
}

/// Prints a warning.
pub(crate) fn warning(message: &str) {
    let (start, end) = if color::is_wanted() { ("\x1b[1;33m", "\x1b[0m") } else { ("", "") };
    message_line(&format!("{start}warning{end}: {message}"));
}

/// Writes a line to standard error.
pub(crate) fn message_line(line: &str) {
    message(&format!("{line}\n"));
}

/// Writes text to standard error. There is nowhere to report a failure.
pub(crate) fn message(text: &str) {
    let _ = stderr().lock().write_all(text.as_bytes());
}

/// Writes a result to standard output.
pub(crate) fn result(text: &str) -> Result<(), Failure> {
    result_bytes(text.as_bytes())
}

/// Writes a file to standard output.
pub(crate) fn result_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::failed(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}
