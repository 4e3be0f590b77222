//! Hundreds of hostile inputs. Each must give a clear error with its place and exit code 2, within
//! seconds and bounded memory, and leave no files. The folder `broken` has scenes that are stored
//! as files. The cases here are single lines, scenes with a broken file beside them, and scenes
//! that are too large to store.
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
