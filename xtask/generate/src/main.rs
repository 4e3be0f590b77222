//! Developer commands that need the renderer: generated files (meshes and pictures of the scenes,
//! the gallery, reference pages, references of tests), the comparison of two binaries, and the
//! export of a scene's triangles for benchmarks. `cargo xtask` calls this program.
#![forbid(unsafe_code)]
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "a developer's tool reads files, prints and exits"
)]

mod assets;
mod bits;
mod docs;
mod gallery;
mod references;
mod repository;
mod test_scenes;
mod triangles;

use std::process::ExitCode;

use clap::Parser;

/// What to do.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
enum Command {
    /// The meshes and pictures that the scenes use
    Assets(assets::Arguments),
    /// Compare the pictures of two binaries bit by bit, and their times
    Bits(bits::Arguments),
    /// The reference pages under docs/
    Docs(docs::Arguments),
    /// The pictures under gallery/
    Gallery(gallery::Arguments),
    /// The references of the test scenes
    References(references::Arguments),
    /// The triangles of a scene, for `bench rays`
    Triangles(triangles::Arguments),
}

fn main() -> ExitCode {
    let outcome = match Command::parse() {
        Command::Assets(arguments) => assets::run(&arguments),
        Command::Bits(arguments) => bits::run(&arguments),
        Command::Docs(arguments) => docs::run(&arguments),
        Command::Gallery(arguments) => gallery::run(&arguments),
        Command::References(arguments) => references::run(&arguments),
        Command::Triangles(arguments) => triangles::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}
