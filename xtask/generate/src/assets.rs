//! `cargo xtask assets`: generates the meshes, pictures and volumes that the scenes under `scenes/`
//! and the test scenes use.
//!
//! They are committed, so a clone renders without this command; `--check` fails if a committed file
//! differs from its generated content.

mod noise;
mod paint;
mod patch;
mod pictures;
mod reference_scenes;
mod sculptures;
mod volumes;

use clap::Args;

use crate::repository::{Made, Mode, write_or_check};

/// What to do with the files.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Write nothing; fail if a file is out of date
    #[arg(long)]
    check: bool,
}

/// A file and the function that generates its bytes.
struct Asset {
    /// Its path from the root of the repository.
    path: &'static str,
    make: fn() -> Vec<u8>,
}

const fn asset(path: &'static str, make: fn() -> Vec<u8>) -> Asset {
    Asset { path, make }
}

/// Every file.
const ASSETS: &[Asset] = &[
    asset("crates/cli/tests/references/scenes/assets/cloud.vol", reference_scenes::cloud),
    asset("crates/cli/tests/references/scenes/assets/distance.vol", reference_scenes::distance),
    asset(
        "crates/cli/tests/references/scenes/assets/environment.exr",
        reference_scenes::environment,
    ),
    asset("crates/cli/tests/references/scenes/assets/normals.png", reference_scenes::normals),
    asset("crates/cli/tests/references/scenes/assets/tiles.png", reference_scenes::tiles),
    asset("scenes/plastics/backdrop.ply", sculptures::backdrop),
    asset("scenes/plastics/knot.ply", sculptures::knot),
    asset("scenes/rough-metals/backdrop.ply", sculptures::backdrop),
    asset("scenes/smoke/smoke.vol", volumes::smoke),
    asset("scenes/soft-shadows/basket.ply", sculptures::basket),
    asset("scenes/textures/bricks-color.png", pictures::bricks_color),
    asset("scenes/textures/bricks-height.png", pictures::bricks_height),
    asset("scenes/textures/holes.png", pictures::holes),
    asset("scenes/textures/wood.png", pictures::wood),
];

/// The maximum size of a file in bytes, to keep clones small.
const SIZE_LIMIT: usize = 500_000;

/// Writes the files, or checks them.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let files: Vec<Made> =
        ASSETS.iter().map(|asset| Made { path: asset.path, bytes: (asset.make)() }).collect();
    if let Some(large) = files.iter().find(|file| file.bytes.len() > SIZE_LIMIT) {
        return Err(format!("{} would have {} bytes", large.path, large.bytes.len()));
    }
    write_or_check(&files, Mode::from_check(arguments.check))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn committed_files_are_what_this_makes() {
        assert_eq!(run(&Arguments { check: true }), Ok(()));
    }
}
