//! The scene document: typed parameters, positions, diagnostics, resources.
#![forbid(unsafe_code)]
