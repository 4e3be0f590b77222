//! Whole pictures beside references, one test for each scene and each way to render it.
//!
//! ```text
//! cargo test -p etendue-cli --test references -- [NAME] [--include-ignored]
//! ```
//!
//! - `scenes`: our own small scenes, from the folder `scenes` beside this file.
//! - `scenes_in_depth`: the same with ten times as many samples; slow, so ignored unless asked for.
//! - `seeds`: the scenes of the renderer that this one succeeds; slow.
//! - `suite`: Mitsuba's own render tests; slow.
//!
//! The last two need files that are not in the repository, in `../shared` or where the environment
//! variable `ETENDUE_SHARED` says. Without them, these tests are reported as ignored. A failed test
//! leaves its pictures in `target/tmp/references`.
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "tests read and write files, and print"
)]

mod cases;
mod comparison;
#[path = "../process/run.rs"]
#[allow(dead_code, reason = "shared with the process tests, which use all of it")]
mod run;
mod scenes;
mod seeds;
mod suite;
mod trial;
mod z_test;

use std::process::ExitCode;

use libtest_mimic::Arguments;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let trials = [scenes::trials(), seeds::trials(), suite::trials()].into_iter().flatten();
    libtest_mimic::run(&arguments, trials.collect()).exit_code()
}
