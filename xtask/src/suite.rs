//! `cargo xtask suite`: scenes beside references and variances that Mitsuba made, by the criterion
//! of Mitsuba's own render tests and by a stricter one.
//!
//! A scene is a file `NAME_INTEGRATOR.xml` beside `refs/NAME_ref_rgb.exr` and
//! `refs/NAME_ref_rgb_var.exr`; its parameters `$spp` and `$integrator` are set from outside.

mod z_test;

use std::path::{Path, PathBuf};

use crate::etendue;
use crate::portable_float_map::{self as float_map, Picture};
use crate::workspace::root;
use z_test::Comparison;

/// Samples for a whole picture.
const SAMPLE_BUDGET: usize = 2_000_000;
/// This share of the pixels' channels must pass the z-test.
const ACCEPTED_LIMIT: f64 = 0.9975;
/// This share of blocks of 8×8 pixels, in percent, may be off by both four standard errors and 2 %:
/// the stricter look, which sees what the z-test lets through at few samples.
const BLOCK_LIMIT: f64 = 10.0;
/// Samples per pixel behind the references.
const REFERENCE_SAMPLES: u32 = 32_000;
/// Where the suite lies beside the repository.
const DEFAULT_FOLDER: &str = "shared/mitsuba-suite";
/// Folders below each other, at most.
const MAX_DEPTH: u32 = 6;

/// One scene with one integrator.
struct Case {
    scene: PathBuf,
    /// The file's name without the integrator.
    name: String,
    integrator: String,
}

/// How a case went.
struct Outcome {
    accepted: f64,
    blocks: f64,
    samples: usize,
}

/// Where the suite is, if it is.
pub(crate) fn folder() -> Option<PathBuf> {
    let folder = root().parent()?.join(DEFAULT_FOLDER);
    folder.is_dir().then_some(folder)
}

/// Tests every scene of a suite: the arguments are its folder, and parts of names that choose some.
pub(crate) fn run(arguments: &[String]) -> bool {
    let (folders, names): (Vec<_>, Vec<_>) =
        arguments.iter().partition(|argument| Path::new(argument).is_dir());
    let Some(suite) = folders.first().map(PathBuf::from).or_else(folder) else {
        eprintln!("there is no ../{DEFAULT_FOLDER}");
        return false;
    };
    let mut cases = Vec::new();
    find_cases(&suite, MAX_DEPTH, &mut cases);
    cases.retain(|case| names.is_empty() || names.iter().any(|name| case.name.contains(*name)));
    if cases.is_empty() {
        eprintln!("{}: no scenes with references", suite.display());
        return false;
    }
    if !etendue::build() {
        return false;
    }
    let passed_count = cases.iter().filter(|case| case.report()).count();
    println!("{passed_count} of {} pass", cases.len());
    passed_count == cases.len()
}

/// Collects the scenes with references in a folder and those within, by name.
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
            // As Mitsuba's tests do: what one tracer of media renders, the other must, too.
            let with_spectral_sampling = (case.integrator == "volpath").then(|| Case {
                scene: path,
                name: case.name.clone(),
                integrator: "volpathmis".to_owned(),
            });
            cases.push(case);
            cases.extend(with_spectral_sampling);
        }
    }
}

impl Case {
    /// The case of a scene file; `None` if it is none, or without references.
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

    /// Runs the case, prints a line, and says whether it passed.
    fn report(&self) -> bool {
        let shown = format!("{:<41} {:<10}", self.name, self.integrator);
        match self.run() {
            Ok(Outcome { accepted, blocks, samples }) => {
                let is_well = accepted >= ACCEPTED_LIMIT && blocks <= BLOCK_LIMIT;
                let verdict = if is_well { "ok" } else { "FAILED" };
                let accepted = 100.0 * accepted;
                println!(
                    "{shown} {samples:>4} spp  accepted {accepted:7.3} %  \
                     blocks off {blocks:6.2} %  {verdict}"
                );
                is_well
            }
            Err(problem) => {
                let first_line = problem.lines().next().unwrap_or_default();
                println!("{shown} FAILED: {first_line}");
                false
            }
        }
    }

    fn run(&self) -> Result<Outcome, String> {
        let folder = etendue::folder("suite")?;
        let file = |what: &str| folder.join(format!("{}_{}{what}", self.name, self.integrator));
        let reference = read(&self.reference(""), &file("_ref.pfm"))?;
        let variance = read(&self.reference("_var"), &file("_var.pfm"))?;
        let samples = (SAMPLE_BUDGET / reference.pixels.len()).max(1);

        self.render(samples, &file(".exr"))?;
        let picture = read(&file(".exr"), &file(".pfm"))?;
        let test = Comparison {
            picture: &picture,
            sample_count: samples as f64,
            reference: &reference,
            variance: &variance,
        };
        let test = test.test()?;

        let variance = format!("{}@{REFERENCE_SAMPLES}", self.reference("_var").display());
        let mut diff = etendue::command();
        diff.arg("diff").arg(file(".exr")).arg(self.reference("")).args(["--variance", &variance]);
        diff.arg("--output").arg(file("_difference.png"));
        let blocks = etendue::diff(&mut diff)?.blocks;

        let outcome = Outcome { accepted: test.accepted, blocks, samples };
        float_map::write(&file("_pvalue.pfm"), &test.p_values)?;
        if outcome.accepted < ACCEPTED_LIMIT || outcome.blocks > BLOCK_LIMIT {
            for what in ["", "_ref", "_pvalue"] {
                convert(&file(&format!("{what}.pfm")), &file(&format!("{what}.png")))?;
            }
        }
        for what in ["", "_ref", "_var", "_pvalue"] {
            std::fs::remove_file(file(&format!("{what}.pfm")))
                .map_err(|error| error.to_string())?;
        }
        Ok(outcome)
    }

    fn render(&self, samples: usize, picture: &Path) -> Result<(), String> {
        let mut render = etendue::command();
        render.arg("render").arg(&self.scene);
        render.args(["-D", &format!("spp={samples}")]);
        render.args(["-D", &format!("integrator={}", self.integrator)]);
        render.args(["--spp", &samples.to_string(), "--variance", "--quiet", "--output"]);
        etendue::output(render.arg(picture)).map(|_| ())
    }
}

/// The colours of any picture, by way of a portable float map.
fn read(picture: &Path, map: &Path) -> Result<Picture, String> {
    convert(picture, map)?;
    float_map::read(map)
}

fn convert(from: &Path, to: &Path) -> Result<(), String> {
    etendue::output(etendue::command().arg("convert").arg(from).arg(to)).map(|_| ())
}
