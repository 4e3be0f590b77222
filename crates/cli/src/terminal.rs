//! Prints messages to standard error and results to standard output.
//!
//! This is the border to the terminal. Texts that contain names or contents of files may contain
//! anything, so control characters are escaped here; the colours and the line breaks are those of the
//! program. A name that is part of a line goes through [`crate::text::path`] or
//! [`printable`](etendue::document::printable) first, so that it cannot break the line.
//!
//! A closed pipe is not an error: `etendue info scene.xml | head -1` must not complain.

use std::io::{ErrorKind, Write, stderr, stdout};

use etendue::document::printable_lines;
use serde_json::Value;

use crate::failure::Failure;
use crate::style;

/// Prints an error.
pub(crate) fn error(message: &str) {
    labelled("error", "\x1b[1;31m", message);
}

/// Prints a warning.
pub(crate) fn warning(message: &str) {
    labelled("warning", "\x1b[1;33m", message);
}

fn labelled(label: &str, color: &str, message: &str) {
    let (start, end) = if style::is_colored() { (color, "\x1b[0m") } else { ("", "") };
    styled(&format!("{start}{label}{end}: {}\n", printable_lines(message)));
}

/// Writes a line to standard error.
pub(crate) fn message_line(line: &str) {
    message(&format!("{line}\n"));
}

/// Writes text to standard error.
pub(crate) fn message(text: &str) {
    styled(&printable_lines(text));
}

/// Writes text with colours to standard error; whoever made it has escaped what comes from outside.
/// There is nowhere to report a failure.
pub(crate) fn styled(text: &str) {
    let _ = stderr().lock().write_all(text.as_bytes());
}

/// Writes a result to standard output.
pub(crate) fn result(text: &str) -> Result<(), Failure> {
    result_bytes(printable_lines(text).as_bytes())
}

/// Writes a value as one line of JSON to standard output.
pub(crate) fn json_line(value: &Value) -> Result<(), Failure> {
    result_bytes(format!("{}\n", escaped(&value.to_string())).as_bytes())
}

/// Writes a value as JSON for people to standard output.
pub(crate) fn json(value: &Value) -> Result<(), Failure> {
    result_bytes(format!("{}\n", escaped(&format!("{value:#}"))).as_bytes())
}

/// Escapes the control characters that JSON permits within strings. They occur nowhere else.
fn escaped(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for character in json.chars() {
        // All of them have four digits.
        match character {
            '\u{7f}'..='\u{9f}'
            | '\u{200e}'
            | '\u{200f}'
            | '\u{2028}'..='\u{202e}'
            | '\u{2066}'..='\u{2069}'
            | '\u{61c}' => {
                text.push_str(&format!("\\u{:04x}", u32::from(character)));
            }
            other => text.push(other),
        }
    }
    text
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

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn json_keeps_its_meaning_and_loses_its_control_characters() {
        let value = json!({ "name": "a\u{1b}[1m\u{9b}2J\u{202e}ä\n" });
        let text = escaped(&value.to_string());
        assert!(!text.contains(|c: char| c.is_control() || c == '\u{202e}'), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }
}
