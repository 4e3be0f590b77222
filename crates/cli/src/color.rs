//! Decides whether messages are coloured.

use std::io::{IsTerminal, stderr};

/// Whether to colour messages: standard error is a terminal, and the environment does not forbid it
/// (<https://no-color.org>).
pub(crate) fn is_wanted() -> bool {
    let is_forbidden = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let is_dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
    stderr().is_terminal() && !is_forbidden && !is_dumb
}
