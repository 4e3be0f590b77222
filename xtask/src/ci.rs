//! `cargo xtask ci [--quick]`: all checks that a change must pass.

use std::process::Command;
use std::time::Instant;

use crate::workspace::{cargo, has_subcommand};
use crate::{deps, etendue, generate, links, package};

/// The result of a step.
enum Outcome {
    Passed,
    Failed,
    /// Skipped, for this reason.
    Skipped(&'static str),
}

/// One check.
struct Step {
    name: &'static str,
    run: fn() -> Outcome,
    /// Whether `--quick` skips it.
    is_slow: bool,
}

/// The checks, quick ones first.
const STEPS: &[Step] = &[
    step("format", format),
    step("dependency edges", || passed(deps::run(&[]))),
    step("links", || passed(links::run(&[]))),
    step("lints", lints),
    step("tests", tests),
    step("documentation", documentation),
    slow_step("generated files", generated_files),
    slow_step("reference renders", reference_renders),
    slow_step("packages", || passed(package::run(&[]))),
    step("unused dependencies", unused_dependencies),
    step("licences", licences),
];

const fn step(name: &'static str, run: fn() -> Outcome) -> Step {
    Step { name, run, is_slow: false }
}

const fn slow_step(name: &'static str, run: fn() -> Outcome) -> Step {
    Step { name, run, is_slow: true }
}

/// Runs every step, even after a failure, and counts the results.
pub(crate) fn run(arguments: &[String]) -> bool {
    let is_quick = match arguments {
        [] => false,
        [flag] if flag == "--quick" => true,
        _ => {
            eprintln!("usage: cargo xtask ci [--quick]");
            return false;
        }
    };
    let mut failed = Vec::new();
    let mut skipped = Vec::new();
    let mut passed_count = 0;
    for step in STEPS {
        println!("== {}", step.name);
        let started = Instant::now();
        let outcome = match step.is_slow && is_quick {
            true => Outcome::Skipped("--quick leaves it out"),
            false => (step.run)(),
        };
        let seconds = started.elapsed().as_secs_f64();
        match outcome {
            Outcome::Passed => {
                passed_count += 1;
                println!("-- {}: passed in {seconds:.1} s\n", step.name);
            }
            Outcome::Failed => {
                failed.push(step.name);
                println!("-- {}: FAILED in {seconds:.1} s\n", step.name);
            }
            Outcome::Skipped(reason) => {
                skipped.push(step.name);
                println!("-- {}: skipped, {reason}\n", step.name);
            }
        }
    }
    for (word, names) in [("skipped", &skipped), ("failed", &failed)] {
        if !names.is_empty() {
            println!("{word}: {}", names.join(", "));
        }
    }
    println!("{passed_count} passed, {} skipped, {} failed", skipped.len(), failed.len());
    failed.is_empty()
}

fn format() -> Outcome {
    succeeds(cargo().args(["fmt", "--all", "--check"]))
}

fn lints() -> Outcome {
    let arguments = ["clippy", "--workspace", "--all-targets", "--quiet", "--", "-D", "warnings"];
    succeeds(cargo().args(arguments))
}

/// All but the slow tests; examples are compiled too.
fn tests() -> Outcome {
    succeeds(cargo().args(["test", "--workspace", "--quiet", "--no-fail-fast"]))
}

/// The seed scenes and Mitsuba's own render tests, with the optimised command, where their files are at
/// hand. The other tests marked `#[ignore]` take long or compile a copy of the workspace:
/// `cargo test --workspace -- --ignored` runs them all.
fn reference_renders() -> Outcome {
    if !etendue::build() {
        return Outcome::Failed;
    }
    let mut command = cargo();
    command.args(["test", "-p", "etendue-cli", "--test", "references", "--no-fail-fast", "--"]);
    // One at a time, because a render uses all threads.
    command.args(["--ignored", "--skip", "scenes_in_depth", "--test-threads=1"]);
    succeeds(command.env("ETENDUE", etendue::path()))
}

fn documentation() -> Outcome {
    let mut command = cargo();
    command.args(["doc", "--workspace", "--no-deps", "--quiet"]);
    succeeds(command.env("RUSTDOCFLAGS", "-D warnings"))
}

/// Checks the reference pages; the tests check the scenes' files.
fn generated_files() -> Outcome {
    passed(generate::docs(&["--check".to_owned()]))
}

fn unused_dependencies() -> Outcome {
    if !has_subcommand("machete") {
        return Outcome::Skipped("cargo-machete is not installed");
    }
    succeeds(cargo().arg("machete"))
}

/// Without advisories, which need a database from the network and change without a commit.
fn licences() -> Outcome {
    if !has_subcommand("deny") {
        return Outcome::Skipped("cargo-deny is not installed");
    }
    succeeds(cargo().args(["deny", "check", "licenses", "bans", "sources"]))
}

fn succeeds(command: &mut Command) -> Outcome {
    match command.status() {
        Ok(status) => passed(status.success()),
        Err(error) => {
            eprintln!("cannot start {:?}: {error}", command.get_program());
            Outcome::Failed
        }
    }
}

fn passed(is_well: bool) -> Outcome {
    if is_well { Outcome::Passed } else { Outcome::Failed }
}
