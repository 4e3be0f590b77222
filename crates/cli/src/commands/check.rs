//! `etendue check`: reports all problems of a scene without rendering it.

use std::path::PathBuf;

use clap::Args;

use super::scene::SceneArguments;
use crate::diagnostics::Detail;
use crate::failure::{Failure, Status};
use crate::{diagnostics, terminal, text};

/// The arguments of `etendue check`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Scene files
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    scene: SceneArguments,
}

/// Loads every scene and prints its diagnostics.
pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let workers = arguments.scene.workers()?;
    let detail = match arguments.scene.detail() {
        Detail::Warnings => Detail::Notes,
        other => other,
    };
    let mut status = Status::Success;
    for path in &arguments.scenes {
        let loaded = arguments.scene.load(path, &workers)?;
        diagnostics::show_list(&loaded.diagnostics, detail);
        if !arguments.scene.quiet {
            let summary = diagnostics::summary(&loaded.diagnostics);
            terminal::result(&format!("{}: {summary}\n", text::path(path)))?;
        }
        if loaded.scene.is_none() {
            status = Status::BadInput;
        }
    }
    Ok(status)
}
