//! The command line: subcommands, and what `--help` ends with.

use clap::{Parser, Subcommand};

use crate::commands::{check, convert, diff, info, merge, render};

/// What every `--help` ends with.
const AFTER_HELP: &str = "\
Exit codes:
  0    everything was done
  1    failed while rendering or writing
  2    bad arguments or input
  130  stopped by Ctrl-C; what was done has been written
  143  stopped by SIGTERM; what was done has been written";

/// A physically based path tracer.
#[derive(Debug, Parser)]
#[command(name = "etendue", version, after_help = AFTER_HELP, propagate_version = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render scenes to picture files.
    #[command(after_help = AFTER_HELP)]
    Render(render::Arguments),
    /// Put parts of a picture, rendered apart with `render --samples`, together.
    #[command(after_help = AFTER_HELP)]
    Merge(merge::Arguments),
    /// Load scenes and report everything that is wrong, without rendering.
    #[command(after_help = AFTER_HELP)]
    Check(check::Arguments),
    /// Show what a scene consists of.
    #[command(after_help = AFTER_HELP)]
    Info(info::Arguments),
    /// Compare a picture with a reference.
    #[command(after_help = AFTER_HELP)]
    Diff(diff::Arguments),
    /// Write a picture in another format.
    #[command(after_help = AFTER_HELP)]
    Convert(convert::Arguments),
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_consistent() {
        Arguments::command().debug_assert();
    }
}
