//! Reads Mitsuba XML, versions 0.4 to 3, into the scene document.
//!
//! [`read_file`] reads a file with everything it includes, substitutes `$names`, upgrades older
//! dialects, and returns a [`Document`] with version 3's element and parameter names. Errors go to
//! [`Diagnostics`] with their positions. Reading continues after an error where it can, so that one
//! run shows them all. Input may be hostile: sizes, nesting and expansions have [`Limits`],
//! entities are rejected, and nothing panics.
#![forbid(unsafe_code)]

mod defines;
mod directives;
mod element;
mod elements;
mod include;
mod loader;
mod numbers;
mod options;
mod origin;
mod pieces;
mod scan;
mod syntax;
mod text;
mod transform;
mod upgrade;
mod values;
mod walk;
mod wrappers;

use std::path::Path;

use etendue_document::{Diagnostics, Document, Resources, Sources};

pub use options::{Limits, LoadOptions};

/// Reads a scene file and everything it includes.
///
/// Findings go to `diagnostics`; [`Diagnostics::has_errors`] says whether the scene can be
/// rendered. After errors, the document holds what could be read, so that errors of the plugins
/// show in the same run.
///
/// # Errors
///
/// If the main file is not a scene at all. The error holds the texts that were read, for the
/// excerpts of the findings.
pub fn read_file(
    path: &Path,
    resources: &dyn Resources,
    options: &LoadOptions,
    diagnostics: &Diagnostics,
) -> Result<Document, Sources> {
    loader::Loader::new(resources, options, diagnostics).load_file(path)
}

/// Like [`read_file`], for a scene in memory whose folder is the working directory of the options.
///
/// # Errors
///
/// Same as [`read_file`].
pub fn read_text(
    text: &str,
    resources: &dyn Resources,
    options: &LoadOptions,
    diagnostics: &Diagnostics,
) -> Result<Document, Sources> {
    loader::Loader::new(resources, options, diagnostics).load_text("<scene>", text)
}
