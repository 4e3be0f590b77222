//! The command line: the subcommands, and the end of every `--help`.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use etendue::document::printable;

use crate::commands::{check, completions, convert, diff, info, merge, render};
use crate::terminal;

/// The text at the end of every `--help`.
const AFTER_HELP: &str = "\
Exit codes:
  0    success
  1    rendering or writing failed, or `diff --fail-above` found too great a difference
  2    invalid arguments or input
  129  stopped by SIGHUP; finished work was saved
  130  stopped by Ctrl-C; finished work was saved
  143  stopped by SIGTERM; finished work was saved";

/// A physically based path tracer.
#[derive(Debug, Parser)]
#[command(name = "etendue", version, after_help = AFTER_HELP, propagate_version = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render scenes to picture files.
    #[command(after_help = AFTER_HELP)]
    Render(Box<render::Arguments>),
    /// Merge parts written by `render --samples` into one picture.
    #[command(after_help = AFTER_HELP)]
    Merge(merge::Arguments),
    /// Load scenes and report all problems, without rendering.
    #[command(after_help = AFTER_HELP)]
    Check(check::Arguments),
    /// Show what a scene contains.
    #[command(after_help = AFTER_HELP)]
    Info(info::Arguments),
    /// Compare a picture with a reference.
    #[command(after_help = AFTER_HELP)]
    Diff(diff::Arguments),
    /// Convert a picture to another format.
    #[command(after_help = AFTER_HELP)]
    Convert(convert::Arguments),
    /// Print completions for a shell.
    #[command(after_help = AFTER_HELP)]
    Completions(completions::Arguments),
    /// Print the manual page.
    #[command(after_help = AFTER_HELP)]
    Man,
}

/// Prints why the arguments are wrong, or the help that they ask for.
pub(crate) fn refuse(error: &clap::Error) -> ExitCode {
    // The message quotes arguments, which may contain anything: it is made again with printable ones.
    let arguments = std::env::args_os();
    let printable = arguments.map(|argument| printable(&argument.to_string_lossy()).into_owned());
    let quoted = Arguments::try_parse_from(printable);
    let text = quoted.as_ref().err().unwrap_or(error).render();
    if error.use_stderr() {
        let message = text.to_string();
        terminal::error(message.strip_prefix("error: ").unwrap_or(&message).trim_end());
    } else if let Err(failure) = terminal::result(&text.to_string()) {
        terminal::error(&failure.message);
        return ExitCode::from(failure.status.code());
    }
    ExitCode::from(error.exit_code() as u8)
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
