//! `cargo xtask docs`: generates the reference pages from the code.

mod command_line;
mod coverage;
mod mitsuba06;
mod plugins;

use clap::Args;

use crate::repository::{Made, Mode, write_or_check};

/// What to do with the pages.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Write nothing; fail if a page is out of date
    #[arg(long)]
    check: bool,
}

/// Writes the pages, or checks them.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let files = [
        Made { path: "docs/command-line.md", bytes: command_line::page()?.into_bytes() },
        Made { path: plugins::PATH, bytes: plugins::page().into_bytes() },
        Made { path: coverage::PATH, bytes: coverage::page().into_bytes() },
    ];
    write_or_check(&files, Mode::from_check(arguments.check))
}
