//! `cargo xtask seeds`: the scenes of the renderer that this one succeeds, beside references made
//! with Mitsuba. They lie outside the repository, in `../shared/seed-scenes`.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::workspace::{cargo, root};

/// A scene below `testcases`, and the size of its reference.
struct Seed {
    file: &'static str,
    reference: &'static str,
    size: &'static str,
    /// Samples per pixel: enough to tell one percent, and for the variance to be known, which caustics
    /// hide at few samples.
    samples: &'static str,
}

const SEEDS: &[Seed] = &[
    Seed { file: "cornellbox1.xml", reference: "cornellbox1", size: "256x256", samples: "64" },
    Seed { file: "cornellbox2.xml", reference: "cornellbox2", size: "256x256", samples: "64" },
    Seed { file: "smallpt.xml", reference: "smallpt", size: "256x192", samples: "256" },
    Seed { file: "spline.xml", reference: "spline", size: "256x256", samples: "256" },
    Seed { file: "coffee/scene.xml", reference: "coffee", size: "240x300", samples: "64" },
    Seed { file: "spaceship/scene.xml", reference: "spaceship", size: "320x180", samples: "64" },
    Seed { file: "kitchen/scene.xml", reference: "kitchen", size: "320x180", samples: "64" },
];

/// Samples behind each reference's variances.
const REFERENCE_SAMPLES: &str = "4096";
/// The mean of each channel may differ by this, in percent.
const MEAN_LIMIT: f64 = 1.0;
/// This share of blocks of 8×8 pixels, in percent, may be off by both four standard errors and 2 %.
const BLOCK_LIMIT: f64 = 3.0;

/// Where the scenes are, if they are.
pub(crate) fn folder() -> Option<PathBuf> {
    let folder = root().parent()?.join("shared/seed-scenes");
    folder.join("refs").is_dir().then_some(folder)
}

/// Renders every scene and compares it; the only argument is the number of samples per pixel.
pub(crate) fn run(arguments: &[String]) -> bool {
    let Some(folder) = folder() else {
        eprintln!("there is no ../shared/seed-scenes");
        return false;
    };
    let built =
        cargo().args(["build", "--quiet", "--release", "--package", "etendue-cli"]).status();
    if !built.is_ok_and(|status| status.success()) {
        return false;
    }
    let mut all_well = true;
    for seed in SEEDS {
        let samples = arguments.first().map_or(seed.samples, String::as_str);
        let well = match compare(&folder, seed, samples) {
            Ok((mean, blocks)) => {
                println!("{:<12} means {mean:+.3} %, blocks off {blocks:.2} %", seed.reference);
                mean.abs() <= MEAN_LIMIT && blocks <= BLOCK_LIMIT
            }
            Err(problem) => {
                println!("{:<12} {problem}", seed.reference);
                false
            }
        };
        all_well &= well;
    }
    all_well
}

/// The difference of the channel that differs most, and the share of blocks off, in percent.
fn compare(folder: &Path, seed: &Seed, samples: &str) -> Result<(f64, f64), String> {
    let binary = root().join("target/release/etendue");
    let picture = root().join("target/seeds").join(format!("{}.exr", seed.reference));
    std::fs::create_dir_all(root().join("target/seeds")).map_err(|error| error.to_string())?;
    let mut render = Command::new(&binary);
    render.arg("render").arg(folder.join("testcases").join(seed.file));
    render.args([
        "--size",
        seed.size,
        "--filter",
        "box",
        "--spp",
        samples,
        "--variance",
        "--quiet",
    ]);
    output(render.arg("--output").arg(&picture))?;
    let reference = |suffix: &str| folder.join(format!("refs/{}{suffix}.exr", seed.reference));
    let variance = format!("{}@{REFERENCE_SAMPLES}", reference("_var").display());
    let mut diff = Command::new(&binary);
    diff.arg("diff").arg(&picture).arg(reference("")).args(["--variance", &variance]);
    let text = output(&mut diff)?;
    parse(&text).ok_or_else(|| format!("`etendue diff` printed something else:\n{text}"))
}

/// What a command prints, or what it complains of.
fn output(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Reads the relative means, the line below `means`, and the stricter line of `blocks`.
fn parse(text: &str) -> Option<(f64, f64)> {
    let means = text.lines().skip_while(|line| !line.starts_with("means")).nth(1)?;
    let means: Vec<f64> = means.split('%').filter_map(|word| word.trim().parse().ok()).collect();
    let largest = means.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let blocks =
        text.lines().find(|line| line.starts_with("blocks") && line.contains("and 2 %"))?;
    Some((largest, blocks.split_whitespace().nth(1)?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_comparison_is_read_from_what_diff_prints() {
        let text = "MSE     5.8e-5\nmeans   -0.000035 0.1 0.2\n        -0.018 % 0.207 % -0.012 %\n\
                    blocks  9.000 % off by more than 4 standard errors (0 of 1024)\n\
                    blocks  1.250 % off by more than 4 standard errors and 2 % (0 of 1024)\n";
        assert_eq!(parse(text), Some((0.207, 1.25)));
        assert_eq!(parse("MSE 1\n"), None);
    }
}
