//! `cargo xtask seeds`: the scenes of the renderer that this one succeeds, beside references made
//! with Mitsuba. They lie outside the repository, in `../shared/seed-scenes`.

use std::path::{Path, PathBuf};

use crate::etendue::{self, Difference};
use crate::workspace::root;

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
    if !etendue::build() {
        return false;
    }
    let mut all_well = true;
    for seed in SEEDS {
        let samples = arguments.first().map_or(seed.samples, String::as_str);
        let well = match compare(&folder, seed, samples) {
            Ok(Difference { mean, blocks }) => {
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

/// Renders one scene and compares it.
fn compare(folder: &Path, seed: &Seed, samples: &str) -> Result<Difference, String> {
    let picture = etendue::folder("seeds")?.join(format!("{}.exr", seed.reference));
    let mut render = etendue::command();
    render.arg("render").arg(folder.join("testcases").join(seed.file));
    render.args(["--size", seed.size, "--filter", "box", "--spp", samples]);
    etendue::output(render.args(["--variance", "--quiet", "--output"]).arg(&picture))?;
    let reference = |suffix: &str| folder.join(format!("refs/{}{suffix}.exr", seed.reference));
    let variance = format!("{}@{REFERENCE_SAMPLES}", reference("_var").display());
    let mut diff = etendue::command();
    diff.arg("diff").arg(&picture).arg(reference("")).args(["--variance", &variance]);
    etendue::diff(&mut diff)
}
