//! Compares the scenes of Etendue's predecessor with references rendered by Mitsuba. The files are
//! not part of the repository; they are expected in `../shared/seed-scenes`.

use std::path::Path;

use libtest_mimic::Trial;

use crate::comparison::{self, Limits, Measured, read_colors};
use crate::trial::{external, output, render, shared_folder};

/// A scene below `testcases`, and the size of its reference.
struct Seed {
    file: &'static str,
    reference: &'static str,
    size: &'static str,
    /// Samples per pixel: enough to resolve one percent, and to estimate the variance of caustics.
    samples: &'static str,
}

const SEEDS: [Seed; 7] = [
    Seed { file: "cornellbox1.xml", reference: "cornellbox1", size: "256x256", samples: "64" },
    Seed { file: "cornellbox2.xml", reference: "cornellbox2", size: "256x256", samples: "64" },
    Seed { file: "smallpt.xml", reference: "smallpt", size: "256x192", samples: "256" },
    Seed { file: "spline.xml", reference: "spline", size: "256x256", samples: "256" },
    Seed { file: "coffee/scene.xml", reference: "coffee", size: "240x300", samples: "64" },
    Seed { file: "spaceship/scene.xml", reference: "spaceship", size: "320x180", samples: "64" },
    Seed { file: "kitchen/scene.xml", reference: "kitchen", size: "320x180", samples: "64" },
];

/// Samples per pixel of the references. Their variance files are for single samples.
const REFERENCE_SAMPLES: f32 = 4096.0;

/// Tolerances for the other filters and tessellations of the references.
const LIMITS: Limits = Limits { mean: 1.0, blocks: 3.0, ..Limits::NONE };

/// One trial for each scene.
pub(crate) fn trials() -> Vec<Trial> {
    let folder = shared_folder("seed-scenes");
    let trial = |seed: &'static Seed| {
        let name = format!("seeds::{}", seed.reference);
        external(name.clone(), folder.clone(), move |folder| seed.check(&name, folder))
    };
    SEEDS.iter().map(trial).collect()
}

impl Seed {
    fn check(&self, name: &str, folder: &Path) -> Result<(), String> {
        let scene = folder.join("testcases").join(self.file);
        let options = ["--size", self.size, "--filter", "box", "--spp", self.samples];
        let picture = output(name, ".exr")?;
        render(&scene, &options.map(str::to_owned), &picture)?;
        let file = |suffix: &str| folder.join(format!("refs/{}{suffix}.exr", self.reference));
        let variance = read_colors(&file("_var"))?;
        let reference = Measured {
            mean: read_colors(&file(""))?,
            variance: comparison::map(&variance, |value| value / REFERENCE_SAMPLES),
        };
        let picture = Measured::read(&picture)?;
        let found = comparison::check(name, [&picture, &reference], 0.0, &LIMITS)?;
        println!("{name}: means differ by {:.3} %, blocks by {:.2} %", found.mean, found.blocks);
        Ok(())
    }
}
