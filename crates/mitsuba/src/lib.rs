//! Mitsuba XML, versions 0.4 to 3, to the scene document.
//!
//! [`read_file`] reads a file with everything it includes, substitutes `$names`, resolves references
//! and upgrades older dialects, and returns a [`Document`] in the element and parameter names of
//! version 3. What it finds wrong goes to [`Diagnostics`] with its place; it goes on after every
//! error that allows it, so that one run shows them all. Input may be hostile: nesting, sizes and
//! expansions have [`Limits`], entities are not accepted, and nothing panics.
#![forbid(unsafe_code)]

mod defines;
mod directives;
mod element;
mod elements;
mod include;
mod loader;
mod numbers;
mod options;
mod pieces;
mod resolve;
mod scan;
mod syntax;
mod text;
mod transform;
mod upgrade;
mod values;

use std::path::Path;

use etendue_document::{Diagnostics, Document, Resources, Sources};

pub use options::{Limits, LoadOptions};

/// Reads a scene file and everything it includes.
///
/// Findings go to `diagnostics`; whether the scene may be rendered is
/// [`Diagnostics::has_errors`]. A document comes back even where there were errors, as far as it
/// could be read, so that errors of the plugins show in the same run.
///
/// # Errors
///
/// Where the main file is no scene at all: then there is nothing but the texts that were read,
/// from which the excerpts of the findings are cut.
pub fn read_file(
    path: &Path,
    resources: &dyn Resources,
    options: &LoadOptions,
    diagnostics: &Diagnostics,
) -> Result<Document, Sources> {
    loader::Loader::new(resources, options, diagnostics).load_file(path)
}

/// The same for a scene in memory, whose folder is the working directory of the options.
///
/// # Errors
///
/// As [`read_file`].
pub fn read_text(
    text: &str,
    resources: &dyn Resources,
    options: &LoadOptions,
    diagnostics: &Diagnostics,
) -> Result<Document, Sources> {
    loader::Loader::new(resources, options, diagnostics).load_text("<scene>", text)
}
