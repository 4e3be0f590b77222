//! `cargo xtask assets`: generates the meshes, pictures and volumes that the scenes under `scenes/`
//! and the test scenes use.
//!
//! Small files are committed, so a clone renders most scenes without this command; `--check` fails if
//! a committed file differs from its generated content. Large files go to `scenes/NAME/generated`,
//! which git ignores.

mod bear;
mod chess;
mod drape;
mod implicit;
mod meadow;
mod noise;
mod paint;
mod patch;
mod pictures;
mod reference_scenes;
mod room;
mod sculptures;
mod seaside;
mod solids;
mod sprig;
mod studios;
mod volumes;
mod watch;
mod woods;

use clap::Args;
#[cfg(test)]
pub(crate) use noise::random;

use crate::repository::{Made, Mode, write_or_check};

/// What to do with the files.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Scenes, by name; all files if none is named
    names: Vec<String>,
    /// Write nothing; fail if a committed file is out of date
    #[arg(long)]
    check: bool,
}

/// A file and the function that generates its bytes.
struct Asset {
    /// Its path from the root of the repository.
    path: &'static str,
    make: fn() -> Vec<u8>,
}

impl Asset {
    fn made(&self) -> Made {
        Made { path: self.path, bytes: (self.make)() }
    }
}

const fn asset(path: &'static str, make: fn() -> Vec<u8>) -> Asset {
    Asset { path, make }
}

/// Every file that is committed.
const COMMITTED: &[Asset] = &[
    asset("crates/cli/tests/references/scenes/assets/cloud.vol", reference_scenes::cloud),
    asset("crates/cli/tests/references/scenes/assets/distance.vol", reference_scenes::distance),
    asset(
        "crates/cli/tests/references/scenes/assets/environment.exr",
        reference_scenes::environment,
    ),
    asset("crates/cli/tests/references/scenes/assets/normals.png", reference_scenes::normals),
    asset("crates/cli/tests/references/scenes/assets/tiles.png", reference_scenes::tiles),
    asset("scenes/chess/dark-grain.png", chess::dark_grain),
    asset("scenes/chess/light-grain.png", chess::light_grain),
    asset("scenes/chess/studio.exr", studios::bright),
    asset("scenes/cloth/studio.exr", studios::bright),
    asset("scenes/cosmetics/backdrop.ply", sculptures::backdrop),
    asset("scenes/cosmetics/leaves.ply", sprig::leaves),
    asset("scenes/cosmetics/stem.ply", sprig::stem),
    asset("scenes/cosmetics/studio.exr", studios::bright),
    asset("scenes/cups/backdrop.ply", sculptures::backdrop),
    asset("scenes/cups/studio.exr", studios::bright),
    asset("scenes/fur/backdrop.ply", sculptures::backdrop),
    asset("scenes/fur/studio.exr", studios::bright),
    asset("scenes/interior/curtain.ply", room::curtain),
    asset("scenes/interior/cushion.ply", seaside::cushion),
    asset("scenes/interior/leaves.ply", sprig::leaves),
    asset("scenes/interior/painting.png", room::painting),
    asset("scenes/interior/stem.ply", sprig::stem),
    asset("scenes/plastics/backdrop.ply", sculptures::backdrop),
    asset("scenes/plastics/knot.ply", sculptures::knot),
    asset("scenes/rough-metals/backdrop.ply", sculptures::backdrop),
    asset("scenes/smoke/smoke.vol", volumes::smoke),
    asset("scenes/soft-shadows/basket.ply", sculptures::basket),
    asset("scenes/textures/bricks-color.png", pictures::bricks_color),
    asset("scenes/textures/bricks-height.png", pictures::bricks_height),
    asset("scenes/textures/holes.png", pictures::holes),
    asset("scenes/textures/wood.png", pictures::wood),
    asset("scenes/villa/boards.png", seaside::boards),
    asset("scenes/villa/cushion.ply", seaside::cushion),
    asset("scenes/villa/headland.ply", seaside::headland),
    asset("scenes/villa/paving.png", seaside::paving),
    asset("scenes/villa/tuft.ply", meadow::tuft_fresh),
    asset("scenes/villa/waves.png", seaside::waves),
    asset("scenes/watch/stripes.png", watch::stripes),
    asset("scenes/watch/studio.exr", studios::dark),
];

/// Every file that is too large for that.
const GENERATED: &[Asset] = &[
    asset("scenes/chess/generated/battlements.ply", chess::battlements),
    asset("scenes/chess/generated/board.ply", chess::board),
    asset("scenes/chess/generated/board.png", chess::board_color),
    asset("scenes/chess/generated/coronet.ply", chess::coronet),
    asset("scenes/chess/generated/cross.ply", chess::cross),
    asset("scenes/chess/generated/knight.ply", chess::knight),
    asset("scenes/cloth/generated/cloth.ply", drape::cloth),
    asset("scenes/fur/generated/fur.txt", bear::fur),
    asset("scenes/fur/generated/skin.ply", bear::skin),
    asset("scenes/interior/generated/parquet.png", room::parquet),
    asset("scenes/meadow/generated/daisy-petals.ply", meadow::daisy_petals),
    asset("scenes/meadow/generated/ground.ply", meadow::ground),
    asset("scenes/meadow/generated/instances.xml", meadow::instances),
    asset("scenes/meadow/generated/leaves.ply", meadow::tree_leaves),
    asset("scenes/meadow/generated/poppy-petals.ply", meadow::poppy_petals),
    asset("scenes/meadow/generated/stalk.ply", meadow::stalk),
    asset("scenes/meadow/generated/trunk.ply", meadow::trunk),
    asset("scenes/meadow/generated/tuft-dry.ply", meadow::tuft_dry),
    asset("scenes/meadow/generated/tuft-fresh.ply", meadow::tuft_fresh),
    asset("scenes/meadow/generated/tuft-green.ply", meadow::tuft_green),
    asset("scenes/watch/generated/balance.ply", watch::balance),
    asset("scenes/watch/generated/bridge.ply", watch::bridge),
    asset("scenes/watch/generated/center-wheel.ply", watch::center_wheel),
    asset("scenes/watch/generated/cock.ply", watch::cock),
    asset("scenes/watch/generated/hairspring.ply", watch::hairspring),
    asset("scenes/watch/generated/jewel.ply", watch::jewel),
    asset("scenes/watch/generated/pinion.ply", watch::pinion),
    asset("scenes/watch/generated/screw.ply", watch::screw),
    asset("scenes/watch/generated/stippling.png", watch::stippling),
    asset("scenes/watch/generated/third-wheel.ply", watch::third_wheel),
];

/// The maximum size of a committed file in bytes, to keep clones small.
const SIZE_LIMIT: usize = 500_000;

/// Writes the files, or checks those that are committed.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let is_chosen = |asset: &&Asset| {
        let is_of = |name: &String| asset.path.starts_with(&format!("scenes/{name}/"));
        arguments.names.is_empty() || arguments.names.iter().any(is_of)
    };
    let files: Vec<Made> = COMMITTED.iter().filter(is_chosen).map(Asset::made).collect();
    if let Some(large) = files.iter().find(|file| file.bytes.len() > SIZE_LIMIT) {
        return Err(format!("{} would have {} bytes", large.path, large.bytes.len()));
    }
    let mode = Mode::from_check(arguments.check);
    write_or_check(&files, mode)?;
    if mode == Mode::Check {
        return Ok(());
    }
    // One at a time: together they are large.
    GENERATED.iter().filter(is_chosen).try_for_each(|asset| asset.made().write())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn committed_files_are_what_this_makes() {
        assert_eq!(run(&Arguments { names: Vec::new(), check: true }), Ok(()));
    }
}
