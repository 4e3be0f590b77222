//! Compares our own small scenes with stored references, which another integrator has rendered, or
//! with closed-form solutions. The table `scenes/cases.txt` lists scenes and options;
//! `scenes/README.md` says how to render the references again.

use std::path::{Path, PathBuf};

use etendue::image::ColorImage;
use libtest_mimic::{Failed, Trial};

use crate::cases::{self, Expected, Row};
use crate::comparison::{self, Limits, Measured};
use crate::trial::{output, render};
use crate::z_test;

/// Samples for a whole picture, in the default and in the slow tests.
const SAMPLE_BUDGETS: [(&str, usize); 2] = [("scenes", 300_000), ("scenes_in_depth", 3_000_000)];
/// The number of renders from which to estimate the variance of `ptracer`.
const PARTICLE_RENDERS: usize = 8;
/// Lower bound for the variance of a single sample, so that rounding to half floats in the stored
/// references does not count where all samples are equal.
const LEAST_VARIANCE: f64 = 1e-4;
/// Mitsuba's criterion, a strict one for blocks, and five standard errors for the means. The criterion
/// accepts 99.75 % of the pixels if their variances are exact; estimates from 5 × 5 pixels miss a few more
/// where rare paths are bright.
const LIMITS: Limits =
    Limits { mean: f64::INFINITY, mean_errors: 5.0, blocks: 3.0, accepted: 99.7 };

/// Fast and slow trials for each scene and variant, and trials of the test harness itself.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = vec![
        Trial::test("criterion::thresholds", || z_test::check_thresholds().map_err(Failed::from)),
        Trial::test("scenes::the_table_is_complete", || {
            the_table_is_complete().map_err(Failed::from)
        }),
        Trial::test("scenes::wrong_picture_fails", || wrong_picture_fails().map_err(Failed::from)),
    ];
    for row in cases::read(&folder()).unwrap() {
        for variant in &row.variants {
            for (group, budget) in SAMPLE_BUDGETS {
                let (row, variant) = (row.clone(), variant.clone());
                let name = format!("{group}::{}::{}", row.scene, short(&variant));
                let own_name = name.clone();
                let run = move || row.check(&own_name, &variant, budget).map_err(Failed::from);
                trials.push(Trial::test(name, run).with_ignored_flag(group != "scenes"));
            }
        }
    }
    trials
}

/// Options as part of a name: `path`, `path_-D_sampler=sobol`; `own` if there are none.
fn short(variant: &[String]) -> String {
    let words: Vec<&str> =
        variant.iter().map(String::as_str).filter(|word| *word != "--integrator").collect();
    if words.is_empty() { "own".to_owned() } else { words.join("_") }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/references/scenes")
}

impl Row {
    fn check(&self, name: &str, variant: &[String], budget: usize) -> Result<(), String> {
        let size = self.size()?;
        let samples = budget.div_ceil(size[0] as usize * size[1] as usize);
        let picture = self.render(name, variant, samples)?.with_smooth_variance();
        let reference = self.reference(size)?;
        let least_variance = LEAST_VARIANCE / samples as f64;
        comparison::check(name, [&picture, &reference], least_variance, &LIMITS).map(|_| ())
    }

    /// Renders the scene. For `ptracer`, estimates the variance from several renders, because the
    /// variances that it writes leave out particles: a pixel does not know which of them belong to
    /// the same sample.
    fn render(&self, name: &str, variant: &[String], samples: usize) -> Result<Measured, String> {
        let file = output(name, ".exr")?;
        let scene = folder().join(format!("{}.xml", self.scene));
        let render = |samples: usize, more: &[String]| {
            let count = ["--spp".to_owned(), samples.to_string()];
            render(&scene, &[&count, variant, more].concat(), &file)?;
            Measured::read(&file)
        };
        if !variant.iter().any(|word| word == "ptracer") {
            return render(samples, &[]);
        }
        let seeds = 2..2 + PARTICLE_RENDERS;
        let renders = seeds.map(|seed| {
            let options = ["--seed".to_owned(), seed.to_string()];
            render(samples.div_ceil(PARTICLE_RENDERS), &options).map(|render| render.mean)
        });
        Measured::of_renders(&renders.collect::<Result<Vec<_>, _>>()?)
    }

    /// Width and height of the stored reference, or 32×32.
    fn size(&self) -> Result<[u32; 2], String> {
        match self.expected {
            Expected::Stored { .. } => {
                let picture = comparison::read(&self.file())?;
                Ok([picture.width, picture.height])
            }
            Expected::Constant(_) => Ok([32, 32]),
        }
    }

    fn file(&self) -> PathBuf {
        folder().join("references").join(format!("{}.exr", self.scene))
    }

    fn reference(&self, [width, height]: [u32; 2]) -> Result<Measured, String> {
        let constant = |color| {
            let pixels = vec![color; width as usize * height as usize];
            ColorImage { width, height, pixels }
        };
        match self.expected {
            Expected::Stored { .. } => read_stored(&self.file()),
            Expected::Constant(color) => {
                Ok(Measured { mean: constant(color), variance: constant([0.0; 3]) })
            }
        }
    }
}

/// Reads a stored reference. It holds standard errors, because variances may exceed the range of
/// half floats.
fn read_stored(path: &Path) -> Result<Measured, String> {
    let picture = comparison::read(path)?;
    let errors = comparison::layer(&picture, "error")
        .ok_or_else(|| format!("{} has no standard errors", path.display()))?;
    let mean = picture.to_color_image().map_err(|error| error.to_string())?;
    Ok(Measured { mean, variance: comparison::map(&errors, |error| error * error) })
}

/// Checks that the table lists every scene and every reference.
fn the_table_is_complete() -> Result<(), String> {
    let rows = cases::read(&folder())?;
    let named = |is_wanted: &dyn Fn(&Row) -> bool| {
        let mut names: Vec<String> =
            rows.iter().filter(|row| is_wanted(row)).map(|row| row.scene.clone()).collect();
        names.sort();
        names
    };
    let files = |folder: &Path, extension: &str| {
        let entries = std::fs::read_dir(folder).unwrap();
        let paths = entries.map(|entry| entry.unwrap().path());
        let paths = paths.filter(|path| path.extension().is_some_and(|found| found == extension));
        let mut names: Vec<String> =
            paths.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    };
    let scenes = (files(&folder(), "xml"), named(&|_| true));
    let stored = files(&folder().join("references"), "exr");
    let references = (stored, named(&|row| matches!(row.expected, Expected::Stored { .. })));
    for (found, expected) in [scenes, references] {
        if found != expected {
            return Err(format!("found {found:?}, but the table lists {expected:?}"));
        }
    }
    Ok(())
}

/// Checks that the comparison rejects a wrong picture, one whose floor is 7 % darker.
fn wrong_picture_fails() -> Result<(), String> {
    let rows = cases::read(&folder())?;
    let row = rows.iter().find(|row| row.scene == "room").ok_or("there is no scene `room`")?;
    let variant = ["-D", "white=0.70"].map(str::to_owned);
    match row.check("scenes::wrong_picture_fails", &variant, SAMPLE_BUDGETS[0].1) {
        Ok(()) => Err("a wrong picture passes".to_owned()),
        Err(problem) if problem.contains("mean_errors") => Ok(()),
        Err(problem) => Err(problem),
    }
}
