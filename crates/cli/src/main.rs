//! The `etendue` command.
//!
//! A host of the library: it reads arguments and files, talks to the terminal, and turns what
//! happened into exit codes. Each subcommand is one file in `commands`.
#![forbid(unsafe_code)]
#![allow(
    clippy::disallowed_methods,
    reason = "files, environment and exit codes are a host's business"
)]

mod alike;
mod arguments;
mod checkpoint_writer;
mod color;
mod commands;
mod diagnostics;
mod failure;
mod memory;
mod output;
mod outputs;
mod parsers;
mod pictures;
mod progress;
mod replay;
mod report;
mod resume;
mod signals;
mod terminal;
mod text;
mod variances;

use std::panic::catch_unwind;
use std::process::ExitCode;

use clap::Parser;

use crate::arguments::{Arguments, Command};
use crate::failure::{Failure, Status};

fn main() -> ExitCode {
    let command = Arguments::parse().command;
    // A panic is a defect of this program, and has said so by now; exit codes keep their meaning.
    let outcome = catch_unwind(|| run(&command)).unwrap_or(Ok(Status::Failed));
    match outcome {
        Ok(status) => ExitCode::from(status.code()),
        Err(failure) => {
            terminal::error(&failure.message);
            ExitCode::from(failure.status.code())
        }
    }
}

fn run(command: &Command) -> Result<Status, Failure> {
    match command {
        Command::Render(arguments) => commands::render::run(arguments),
        Command::Merge(arguments) => commands::merge::run(arguments),
        Command::Check(arguments) => commands::check::run(arguments),
        Command::Info(arguments) => commands::info::run(arguments),
        Command::Diff(arguments) => commands::diff::run(arguments),
        Command::Convert(arguments) => commands::convert::run(arguments),
    }
}
