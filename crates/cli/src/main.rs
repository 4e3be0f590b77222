//! The `etendue` command.
//!
//! It hosts the library: it reads arguments and files, prints to the terminal, and sets the exit
//! code. Each subcommand is one file in `commands`.
#![forbid(unsafe_code)]
#![allow(clippy::disallowed_methods, reason = "the host owns files, environment and exit codes")]

mod arguments;
mod checkpoint_writer;
mod commands;
mod diagnostics;
mod display;
mod failure;
mod listing;
mod memory;
mod origin;
mod output;
mod output_lock;
mod outputs;
mod parsers;
mod pictures;
mod progress;
mod replay;
mod report;
mod resume;
mod signals;
mod style;
mod terminal;
mod text;
mod variances;

use std::panic::catch_unwind;
use std::process::ExitCode;

use clap::Parser;

use crate::arguments::{Arguments, Command};
use crate::failure::{Failure, Status};

fn main() -> ExitCode {
    let command = match Arguments::try_parse() {
        Ok(arguments) => arguments.command,
        Err(error) => return arguments::refuse(&error),
    };
    // The panic hook has printed the message already; here the panic only sets the exit code.
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
        Command::Completions(arguments) => commands::completions::run(arguments),
        Command::Man => commands::completions::manual(),
    }
}
