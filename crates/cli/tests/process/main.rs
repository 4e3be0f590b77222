//! Runs the `etendue` command as a user does, and checks exit codes, messages and files.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]

mod broken;
mod checkpoints;
mod docs;
mod forged;
mod limits;
mod merging;
mod outputs;
mod pictures;
mod render;
mod run;
mod scenes;
#[cfg(unix)]
mod signals;
mod terminal;
