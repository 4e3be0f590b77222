//! `cargo xtask bits`: compares the pictures of two `etendue` binaries bit by bit, and their times.
//!
//! The scenes are those under `scenes/`, the test scenes with every integrator of their table, and,
//! if `../shared` exists beside the repository, the seed scenes and Mitsuba's render tests.

mod scenes;
mod times;

use std::path::{Path, PathBuf};

use clap::Args;
use etendue::image::{Picture, decode_picture};

use crate::repository::root;
use crate::test_scenes::{build, render};
use scenes::Case;
use times::{Pair, Times};

/// What to compare.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The old `etendue` command
    #[arg(long, value_name = "FILE")]
    before: PathBuf,
    /// The new `etendue` command; this checkout's if not given
    #[arg(long, value_name = "FILE")]
    after: Option<PathBuf>,
    /// Samples per pixel
    #[arg(long, value_name = "COUNT", default_value_t = 4)]
    spp: u32,
    /// The number of rounds in which both render every scene; all rounds count for the times
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// The folder of the seed scenes and of Mitsuba's render tests; skipped if it does not exist
    #[arg(long, value_name = "FOLDER", default_value_os_t = root().join("../shared"))]
    shared: PathBuf,
    /// Compare only scenes whose names contain this
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
    /// More options for the new binary, such as `--portable` or `--seed 1`
    #[arg(last = true, value_name = "OPTION")]
    options: Vec<String>,
}

/// Renders, compares and prints.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let after = arguments.after.clone().map_or_else(build, Ok)?;
    let folder = root().join("target/bits");
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let mut cases = scenes::all(&arguments.shared)?;
    cases.retain(|case| case.name.contains(&arguments.only));
    if cases.is_empty() {
        return Err(format!("no scene's name contains `{}`", arguments.only));
    }
    let binaries = [
        Binary { path: &arguments.before, options: &[], folder: folder.join("before") },
        Binary { path: &after, options: &arguments.options, folder: folder.join("after") },
    ];
    let mut pairs = Vec::new();
    let mut different_count = 0;
    for case in &cases {
        match compare_binaries(case, &binaries, arguments, &mut pairs) {
            Ok(None) => {}
            Ok(Some(difference)) => {
                different_count += 1;
                println!("DIFFERS {}: {difference}", case.name);
            }
            Err(problem) => {
                different_count += 1;
                println!("FAILED {}: {}", case.name, problem.trim_end());
            }
        }
    }
    println!("{} of {} scenes equal, bit for bit", cases.len() - different_count, cases.len());
    print!("{}", times::report(&pairs));
    if different_count == 0 { Ok(()) } else { Err(format!("{different_count} scenes differ")) }
}

/// One of the two commands.
struct Binary<'a> {
    path: &'a Path,
    options: &'a [String],
    folder: PathBuf,
}

/// Renders a scene with both and reports differences. The two alternate in going first.
fn compare_binaries(
    case: &Case,
    [before, after]: &[Binary<'_>; 2],
    arguments: &Arguments,
    pairs: &mut Vec<Pair>,
) -> Result<Option<String>, String> {
    let mut difference = None;
    for round in 0..arguments.rounds {
        let (old, new) = if (pairs.len() as u32 + round).is_multiple_of(2) {
            let old = before.render(case, arguments.spp)?;
            (old, after.render(case, arguments.spp)?)
        } else {
            let new = after.render(case, arguments.spp)?;
            (before.render(case, arguments.spp)?, new)
        };
        pairs.push(Pair { before: old.times, after: new.times });
        let found =
            old.pictures.iter().zip(&new.pictures).find_map(|(a, b)| first_difference(a, b));
        difference = difference.or(found);
    }
    Ok(difference)
}

/// The output of a render.
struct Rendered {
    /// The colours in full precision, and all channels in the scene's precision.
    pictures: Vec<Picture>,
    times: Times,
}

impl Binary<'_> {
    fn render(&self, case: &Case, samples: u32) -> Result<Rendered, String> {
        std::fs::create_dir_all(&self.folder).map_err(|error| error.to_string())?;
        let files =
            ["pfm", "exr"].map(|extension| self.folder.join(format!("picture.{extension}")));
        let mut command = render(self.path, &case.scene, &case.options);
        command.args(["--spp", &samples.to_string()]).args(self.options);
        for file in &files {
            // Do not compare the output of an earlier render.
            let _ = std::fs::remove_file(file);
            command.arg("--output").arg(file);
        }
        let times = times::measure(&mut command)?;
        let read = |file: &PathBuf| {
            let message = |error: &dyn std::fmt::Display| format!("{}: {error}", file.display());
            let bytes = std::fs::read(file).map_err(|error| message(&error))?;
            decode_picture(&bytes, &file.to_string_lossy()).map_err(|error| message(&error))
        };
        let pictures = files.iter().map(read).collect::<Result<_, String>>()?;
        Ok(Rendered { pictures, times })
    }
}

/// The first difference: sizes, channels, or the bits of their values.
fn first_difference(before: &Picture, after: &Picture) -> Option<String> {
    let sizes = [before, after].map(|picture| (picture.width, picture.height));
    if sizes[0] != sizes[1] {
        return Some(format!("sizes {:?} and {:?}", sizes[0], sizes[1]));
    }
    let names = [before, after].map(|picture| -> Vec<&str> {
        picture.channels.iter().map(|channel| channel.name.as_str()).collect()
    });
    if names[0] != names[1] {
        return Some(format!("channels {:?} and {:?}", names[0], names[1]));
    }
    before.channels.iter().zip(&after.channels).find_map(|(old, new)| {
        let values = old.data.iter().zip(&new.data);
        let different: Vec<(&f32, &f32)> =
            values.filter(|(a, b)| a.to_bits() != b.to_bits()).collect();
        let largest = different.iter().map(|(a, b)| (*a - *b).abs()).fold(0.0, f32::max);
        let (count, all) = (different.len(), old.data.len());
        (count > 0).then(|| {
            format!("channel {}: {count} of {all} values, by {largest:e} at most", old.name)
        })
    })
}

#[cfg(test)]
mod tests {
    use etendue::{RenderOptions, SceneOptions, render_text};

    use super::*;

    const SCENE: &str = r#"<scene version="3.0.0"><integrator type="path"/>
        <sensor type="perspective">
            <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film>
        </sensor>
        <emitter type="constant"/><shape type="sphere"/></scene>"#;

    fn picture(seed: u64) -> Picture {
        let options = RenderOptions {
            samples_per_pixel: Some(4),
            seed: Some(seed),
            ..RenderOptions::default()
        };
        render_text(SCENE, &SceneOptions::default(), &options).unwrap().picture
    }

    #[test]
    fn the_same_render_is_equal_and_another_seed_is_not() {
        assert_eq!(first_difference(&picture(0), &picture(0)), None);
        let difference = first_difference(&picture(0), &picture(1)).unwrap();
        assert!(difference.contains("of 64 values"), "{difference}");
    }

    #[test]
    fn one_bit_in_any_channel_is_a_difference() {
        let before = picture(0);
        for channel in 0..before.channels.len() {
            let mut after = before.clone();
            let value = &mut after.channels[channel].data[9];
            *value = f32::from_bits(value.to_bits() ^ 1);
            assert!(first_difference(&before, &after).unwrap().contains("1 of 64 values"));
        }
        let mut zero = before.clone();
        zero.channels[0].data[0] = 0.0;
        let mut negative_zero = zero.clone();
        negative_zero.channels[0].data[0] = -0.0;
        assert!(first_difference(&zero, &negative_zero).is_some());
    }

    #[test]
    fn a_channel_more_or_less_is_a_difference() {
        let before = picture(0);
        let mut after = before.clone();
        after.channels.pop();
        assert!(first_difference(&before, &after).unwrap().contains("channels"));
    }
}
