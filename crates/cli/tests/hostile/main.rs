//! Hostile input by the hundred: whatever is broken, a clear error with its place, exit code 2, in
//! seconds, within bounded memory, and no file left. The folder `broken` has the scenes that are
//! files; here are those that are one line, those that need a broken file beside them, and those
//! that are too large to keep.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]

mod case;
mod elements;
mod large;
mod meshes;
mod non_finite;
mod pictures;
mod repeated;
#[path = "../process/run.rs"]
#[allow(dead_code, reason = "shared with the process tests, which use all of it")]
mod run;
mod texts;
