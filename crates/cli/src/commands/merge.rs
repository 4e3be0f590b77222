//! `etendue merge`: merges separately rendered parts into one picture.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;
use etendue::merge::{MergeError, Missing, merge};
use etendue::{FilmFileError, SumsFile};

use crate::failure::{Failure, Status};
use crate::outputs::{Outputs, Product};
use crate::{memory, replay, report, terminal};

/// The arguments of `etendue merge`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The parts, in any order
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// Output file: a picture by extension, or a larger .part. Repeat for several files
    #[arg(short = 'o', long, value_name = "FILE", required = true)]
    output: Vec<PathBuf>,
    /// Write the picture even if the parts lack some of its samples
    #[arg(long)]
    allow_missing: bool,
    /// Print only errors
    #[arg(short = 'q', long)]
    quiet: bool,
}

/// Reads and checks all parts, adds them up, and writes the outputs.
pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let outputs = Outputs::new(&arguments.output, Product::Pictures)?;
    let files: Vec<SumsFile> = arguments.parts.iter().map(SumsFile::new).collect();
    // A larger part may lack samples at either end, but not in between.
    let missing = match arguments.allow_missing || !outputs.has_pictures() {
        true => Missing::Allowed,
        false => Missing::Refused,
    };
    let limit = memory::available().unwrap_or(etendue::DEFAULT_MEMORY_LIMIT);
    let merged = merge(&files, missing, limit).map_err(failure)?;
    let planned = merged.record.planned_samples;
    let is_within = |gap: &Range<u32>| gap.start > 0 && gap.end < planned;
    if outputs.has_parts() && merged.missing.iter().any(is_within) {
        return Err(failure(MergeError::Missing(merged.missing)));
    }
    if arguments.allow_missing && !merged.missing.is_empty() {
        terminal::warning(&MergeError::Missing(merged.missing.clone()).to_string());
    }
    let rendering = merged
        .develop()
        .ok_or_else(|| Failure::bad_input("the parts do not say how to make their picture"))?;
    let written = outputs.write_pictures(&rendering);
    let written = written.max(outputs.write_parts(&merged.film, &merged.record));
    report::clamped(&rendering);
    replay::report_without_command(&rendering.statistics.defects);
    if written == Status::Success && !arguments.quiet {
        report::written(&rendering, &outputs);
    }
    Ok(written)
}

/// Errors of the operating system are failures; all others are due to the parts.
fn failure(error: MergeError) -> Failure {
    match &error {
        MergeError::File(_, FilmFileError::Io(io)) if io.kind() != std::io::ErrorKind::NotFound => {
            Failure::failed(error)
        }
        _ => Failure::bad_input(error),
    }
}
