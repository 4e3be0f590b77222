//! Makes the committed files that no hand writes: meshes and pictures of the scenes, the gallery,
//! reference pages; and what other commands need of a scene. `cargo xtask` calls it.
#![forbid(unsafe_code)]
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "a developer's tool reads files, prints and exits"
)]

mod assets;
mod docs;
mod gallery;
mod repository;
mod triangles;

use std::process::ExitCode;

use clap::Parser;

/// What to make.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
enum Command {
    /// The meshes and pictures that the scenes use
    Assets(assets::Arguments),
    /// The reference pages under docs/
    Docs(docs::Arguments),
    /// The pictures under gallery/
    Gallery(gallery::Arguments),
    /// The triangles of a scene, for `bench rays`
    Triangles(triangles::Arguments),
}

fn main() -> ExitCode {
    let outcome = match Command::parse() {
        Command::Assets(arguments) => assets::run(&arguments),
        Command::Docs(arguments) => docs::run(&arguments),
        Command::Gallery(arguments) => gallery::run(&arguments),
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
