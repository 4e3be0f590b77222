//! Developer commands: every change must pass `cargo xtask ci`.
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
mod links;
mod package;
mod workspace;

use std::process::ExitCode;

/// A developer command.
struct Task {
    name: &'static str,
    about: &'static str,
    /// Takes the arguments after the command's name; returns whether it succeeded.
    run: fn(&[String]) -> bool,
}

/// Every command, one line each.
const TASKS: &[Task] = &[
    Task { name: "ci", about: "the gate: [--quick] leaves out what is slow", run: ci::run },
    Task { name: "assets", about: "meshes and pictures of the scenes", run: generate::assets },
    Task { name: "bench", about: "speed, beside a peer", run: bench::run },
    Task { name: "bits", about: "the pictures of two binaries, bit by bit", run: generate::bits },
    Task { name: "deps", about: "edges between crates against the table", run: deps::run },
    Task { name: "docs", about: "reference pages from what the code says", run: generate::docs },
    Task { name: "gallery", about: "the pictures under gallery/", run: generate::gallery },
    Task { name: "links", about: "relative links in Markdown files", run: links::run },
    Task { name: "package", about: "packages: complete, publishable", run: package::run },
    Task { name: "references", about: "references of test scenes", run: generate::references },
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
