//! Mitsuba's own render tests, with its own criterion and a stricter one. The files are not part of
//! the repository; they are expected in `../shared/mitsuba-suite`.
//!
//! A scene is a file `NAME_INTEGRATOR.xml` beside `refs/NAME_ref_rgb.exr` and
//! `refs/NAME_ref_rgb_var.exr`. The test sets its parameters `$spp` and `$integrator`.

use std::path::{Path, PathBuf};

use libtest_mimic::Trial;

use crate::comparison::{self, Difference, Limits, Measured, read_colors};
use crate::trial::{external, output, render, shared_folder};

/// Samples for a whole picture.
const SAMPLE_BUDGET: usize = 2_000_000;
/// Samples per pixel behind the references.
const REFERENCE_SAMPLES: f32 = 32_000.0;
/// Lower bound for the variance of a single sample, so that rounding does not count where the
/// reference has no variance.
const LEAST_VARIANCE: f64 = 1e-4;
/// How deep to search folders for scenes.
const MAX_DEPTH: u32 = 6;

/// Mitsuba's criterion.
const Z_TEST_LIMITS: Limits = Limits { accepted: 99.75, ..Limits::NONE };
/// A stricter criterion, which finds errors that a z-test for each pixel misses at few samples.
const BLOCK_LIMITS: Limits = Limits { blocks: 10.0, ..Limits::NONE };

/// One scene with one integrator.
#[derive(Clone)]
struct Case {
    scene: PathBuf,
    /// The file's name without the integrator.
    name: String,
    integrator: String,
}

/// One trial for each scene and integrator, or a single ignored one if the suite is missing.
pub(crate) fn trials() -> Vec<Trial> {
    let folder = shared_folder("mitsuba-suite");
    let mut cases = Vec::new();
    find_cases(&folder, MAX_DEPTH, &mut cases);
    if cases.is_empty() {
        let problem = |folder: &Path| Err(format!("{}: no scenes", folder.display()));
        return vec![external("suite::all".to_owned(), folder, problem)];
    }
    let trial = |case: Case| {
        let name = format!("suite::{}::{}", case.name, case.integrator);
        external(name.clone(), folder.clone(), move |_| case.check(&name))
    };
    cases.into_iter().map(trial).collect()
}

/// Collects the scenes with references in a folder and below, by name.
fn find_cases(folder: &Path, depth: u32, cases: &mut Vec<Case>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() && depth > 0 {
            find_cases(&path, depth - 1, cases);
        } else if let Some(case) = Case::new(&path) {
            // As in Mitsuba's tests, both volumetric integrators must give the same picture.
            let other = Case { integrator: "volpathmis".to_owned(), ..case.clone() };
            let has_media = case.integrator == "volpath";
            cases.push(case);
            cases.extend(has_media.then_some(other));
        }
    }
}

impl Case {
    /// The case of a scene file; `None` for other files and for scenes without references.
    fn new(scene: &Path) -> Option<Self> {
        if scene.extension()? != "xml" {
            return None;
        }
        let (name, integrator) = scene.file_stem()?.to_str()?.rsplit_once('_')?;
        let case = Self {
            scene: scene.to_path_buf(),
            name: name.to_owned(),
            integrator: integrator.to_owned(),
        };
        ["", "_var"].iter().all(|suffix| case.reference(suffix).is_file()).then_some(case)
    }

    fn reference(&self, suffix: &str) -> PathBuf {
        self.scene.with_file_name("refs").join(format!("{}_ref_rgb{suffix}.exr", self.name))
    }

    fn check(&self, name: &str) -> Result<(), String> {
        let reference = read_colors(&self.reference(""))?;
        let variance = read_colors(&self.reference("_var"))?;
        let samples = (SAMPLE_BUDGET / reference.pixels.len()).max(1);
        let options = [
            "-D".to_owned(),
            format!("spp={samples}"),
            "-D".to_owned(),
            format!("integrator={}", self.integrator),
            "--spp".to_owned(),
            samples.to_string(),
        ];
        let file = output(name, ".exr")?;
        render(&self.scene, &options, &file)?;
        let picture = Measured::read(&file)?;
        // Mitsuba treats the reference as exact, and uses its variance for the picture.
        let scaled = |count: f32| comparison::map(&variance, move |value| value / count);
        let known = Measured { mean: picture.mean.clone(), variance: scaled(samples as f32) };
        let exact = Measured { mean: reference.clone(), variance: scaled(f32::INFINITY) };
        let least_variance = LEAST_VARIANCE / samples as f64;
        let Difference { accepted, .. } =
            comparison::check(name, [&known, &exact], least_variance, &Z_TEST_LIMITS)?;
        // The block test uses the variances of both pictures.
        let reference = Measured { mean: reference, variance: scaled(REFERENCE_SAMPLES) };
        let Difference { blocks, .. } =
            comparison::check(name, [&picture, &reference], least_variance, &BLOCK_LIMITS)?;
        println!("{name}: {samples} spp, accepted {accepted:.3} %, blocks off {blocks:.2} %");
        Ok(())
    }
}
