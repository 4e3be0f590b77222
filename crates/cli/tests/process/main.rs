//! The `etendue` command as a user runs it: exit codes, messages, files left behind.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]

mod broken;
mod keeping;
mod merging;
mod pictures;
mod render;
mod run;
mod scenes;
#[cfg(unix)]
mod signals;
