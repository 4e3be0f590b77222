//! Whether messages are coloured.

use std::io::{IsTerminal, stderr};

/// Whether standard error shows colours: it is a terminal, and nobody objects
/// (<https://no-color.org>).
pub(crate) fn is_wanted() -> bool {
    let objection = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let is_dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
    stderr().is_terminal() && !objection && !is_dumb
}
