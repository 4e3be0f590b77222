//! Developer commands: `cargo xtask ci` is the gate that every change passes.
#![forbid(unsafe_code)]
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "a developer's tool reads files, prints and exits"
)]

mod bench;
mod ci;
mod deps;
mod etendue;
mod generate;
mod kill;
mod leaks;
mod links;
mod openjd;
mod package;
mod portable_float_map;
mod seeds;
mod slurm;
mod soak;
mod splines;
mod suite;
mod workspace;

use std::process::ExitCode;

/// A developer command.
struct Task {
    name: &'static str,
    about: &'static str,
    /// Gets the arguments after the name; returns whether all is well.
    run: fn(&[String]) -> bool,
}

/// Every command, one line each.
const TASKS: &[Task] = &[
    Task { name: "ci", about: "format, lints, tests, docs, edges, licences", run: ci::run },
    Task { name: "assets", about: "meshes and pictures of the scenes", run: generate::assets },
    Task { name: "deps", about: "edges between crates against the table", run: deps::run },
    Task { name: "docs", about: "reference pages from what the code says", run: generate::docs },
    Task { name: "gallery", about: "the pictures under gallery/", run: generate::gallery },
    Task { name: "kill", about: "renders killed and resumed: [COUNT] [SEED]", run: kill::run },
    Task {
        name: "leaks",
        about: "rays at edges of closed meshes: none slips through",
        run: leaks::run,
    },
    Task { name: "links", about: "relative links in Markdown files", run: links::run },
    Task { name: "openjd", about: "the template for Open Job Description", run: openjd::run },
    Task { name: "package", about: "packages: complete, publishable", run: package::run },
    Task { name: "seeds", about: "the seed scenes beside their references", run: seeds::run },
    Task { name: "slurm", about: "the scripts for Slurm, on a real one", run: slurm::run },
    Task { name: "soak", about: "constant memory: [MINUTES] [SCENE]", run: soak::run },
    Task { name: "splines", about: "rays through spline surfaces: none lost", run: splines::run },
    Task { name: "suite", about: "Mitsuba's own render tests: [DIR] [NAME...]", run: suite::run },
    Task { name: "bench", about: "speed, beside a peer", run: bench::run },
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let name = arguments.first().map(String::as_str);
    let Some(task) = TASKS.iter().find(|task| Some(task.name) == name) else {
        eprintln!("usage: cargo xtask COMMAND [ARGUMENTS]\n");
        for task in TASKS {
            eprintln!("  {:<10} {}", task.name, task.about);
        }
        return ExitCode::from(2);
    };
    if (task.run)(&arguments[1..]) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
