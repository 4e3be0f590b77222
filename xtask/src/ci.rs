//! `cargo xtask ci [--slurm]`: everything that a change must pass.

use std::process::Command;
use std::time::Instant;

use crate::workspace::{cargo, has_subcommand};
use crate::{deps, generate, leaks, links, openjd, package, seeds, slurm, splines, suite};

/// How a step ended.
enum Outcome {
    Passed,
    Failed,
    /// Not run, for this reason.
    Skipped(&'static str),
}

/// One check.
struct Step {
    name: &'static str,
    run: fn() -> Outcome,
}

/// The checks, the quick ones first.
const STEPS: &[Step] = &[
    Step { name: "format", run: format },
    Step { name: "dependency edges", run: || passed(deps::run(&[])) },
    Step { name: "links", run: || passed(links::run(&[])) },
    Step { name: "lints", run: lints },
    Step { name: "tests", run: tests },
    Step { name: "leaks", run: || passed(leaks::run(&[])) },
    Step { name: "splines", run: || passed(splines::run(&[])) },
    Step { name: "generated files", run: generated_files },
    Step { name: "documentation", run: documentation },
    Step { name: "seed scenes", run: seed_scenes },
    Step { name: "render tests", run: render_tests },
    Step { name: "packages", run: || passed(package::run(&[])) },
    Step { name: "unused dependencies", run: unused_dependencies },
    Step { name: "licences", run: licences },
];

/// The checks that need a farm's programs, asked for by `--slurm`.
const FARM_STEPS: &[Step] = &[
    Step { name: "Slurm", run: slurm_scripts },
    Step { name: "Open Job Description", run: openjd_template },
];

/// Runs every step, also after one has failed, and counts.
pub(crate) fn run(arguments: &[String]) -> bool {
    let with_farms = arguments.iter().any(|argument| argument == "--slurm");
    let farm_steps = if with_farms { FARM_STEPS } else { &[] };
    let mut failed = Vec::new();
    let mut passed_count = 0;
    for step in STEPS.iter().chain(farm_steps) {
        println!("== {}", step.name);
        let started = Instant::now();
        let outcome = (step.run)();
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
            Outcome::Skipped(reason) => println!("-- {}: skipped, {reason}\n", step.name),
        }
    }
    if !failed.is_empty() {
        println!("failed: {}", failed.join(", "));
    }
    println!("{passed_count} passed, {} failed", failed.len());
    failed.is_empty()
}

fn format() -> Outcome {
    succeeds(cargo().args(["fmt", "--all", "--check"]))
}

fn lints() -> Outcome {
    let arguments = ["clippy", "--workspace", "--all-targets", "--quiet", "--", "-D", "warnings"];
    succeeds(cargo().args(arguments))
}

fn tests() -> Outcome {
    succeeds(cargo().args(["test", "--workspace", "--quiet", "--no-fail-fast"]))
}

/// The tests check the scenes' files; the pages need the built `etendue` command.
fn generated_files() -> Outcome {
    passed(generate::docs(&["--check".to_owned()]))
}

fn documentation() -> Outcome {
    let mut command = cargo();
    command.args(["doc", "--workspace", "--no-deps", "--quiet"]);
    succeeds(command.env("RUSTDOCFLAGS", "-D warnings"))
}

/// The pictures are right, as far as the references are at hand.
fn seed_scenes() -> Outcome {
    match seeds::folder() {
        Some(_) => passed(seeds::run(&[])),
        None => Outcome::Skipped("../shared/seed-scenes is not there"),
    }
}

/// Mitsuba's own render tests, where they are at hand.
fn render_tests() -> Outcome {
    match suite::folder() {
        Some(_) => passed(suite::run(&[])),
        None => Outcome::Skipped("../shared/mitsuba-suite is not there"),
    }
}

/// An array of jobs on a Slurm of its own.
fn slurm_scripts() -> Outcome {
    match slurm::why_not() {
        None => passed(slurm::run(&[])),
        Some(reason) => Outcome::Skipped(reason),
    }
}

fn openjd_template() -> Outcome {
    if !openjd::is_there() {
        return Outcome::Skipped("openjd-cli is not installed");
    }
    passed(openjd::run(&[]))
}

fn unused_dependencies() -> Outcome {
    if !has_subcommand("machete") {
        return Outcome::Skipped("cargo-machete is not installed");
    }
    succeeds(cargo().arg("machete"))
}

/// Advisories are left out: they need a database from the network, and change without a commit.
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
