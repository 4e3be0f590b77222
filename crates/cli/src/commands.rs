//! The subcommands, one file each: its arguments and `run`.

pub(crate) mod check;
pub(crate) mod completions;
pub(crate) mod convert;
pub(crate) mod diff;
pub(crate) mod info;
pub(crate) mod merge;
pub(crate) mod render;
pub(crate) mod scene;
