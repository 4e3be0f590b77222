//! The scenes whose pictures are compared.

use std::path::{Path, PathBuf};

use crate::repository::{has_generated_files, root};
use crate::test_scenes::{cases, folder};

/// A scene and how it is rendered.
pub(super) struct Case {
    pub(super) name: String,
    pub(super) scene: PathBuf,
    pub(super) options: Vec<String>,
}

/// The seed scenes and their render sizes.
const SEEDS: [(&str, &str); 7] = [
    ("cornellbox1.xml", "128x128"),
    ("cornellbox2.xml", "128x128"),
    ("smallpt.xml", "128x96"),
    ("spline.xml", "128x128"),
    ("coffee/scene.xml", "120x150"),
    ("spaceship/scene.xml", "160x90"),
    ("kitchen/scene.xml", "160x90"),
];

/// The maximum depth of the search for scene files.
const MAX_DEPTH: u32 = 6;

/// All scenes of the repository, and those present in the folder `shared`.
///
/// # Errors
/// If the table of the test scenes cannot be read.
pub(super) fn all(shared: &Path) -> Result<Vec<Case>, String> {
    let mut all = gallery();
    all.extend(test_scenes()?);
    for (file, size) in SEEDS {
        let scene = shared.join("seed-scenes/testcases").join(file);
        if scene.is_file() {
            let name = format!("seeds/{}", file.trim_end_matches("/scene.xml"));
            all.push(Case { name, scene, options: options(&["--size", size]) });
        }
    }
    let mut files = Vec::new();
    find_scenes(&shared.join("mitsuba-suite"), MAX_DEPTH, &mut files);
    all.extend(files.into_iter().flat_map(suite_cases));
    Ok(all)
}

fn options(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

/// The scenes under `scenes/`, at a small size; those whose files are not generated are skipped.
fn gallery() -> Vec<Case> {
    let case = |folder: PathBuf| {
        let name = format!("scenes/{}", folder.file_name()?.to_string_lossy());
        let scene = folder.join("scene.xml");
        if !has_generated_files(&scene) {
            eprintln!("{name} is left out: `cargo xtask assets` makes its files");
            return None;
        }
        let options = options(&["--size", "160x120"]);
        scene.is_file().then_some(Case { name, scene, options })
    };
    sorted_entries(&root().join("scenes")).into_iter().filter_map(case).collect()
}

/// The test scenes in every variant of their table.
fn test_scenes() -> Result<Vec<Case>, String> {
    let rows = cases::read(&folder())?;
    let variants = rows.into_iter().flat_map(|row| {
        let scene = folder().join(format!("{}.xml", row.scene));
        row.variants.into_iter().map(move |options| {
            let name = format!("tests/{} {}", row.scene, options.join(" "));
            Case { name, scene: scene.clone(), options }
        })
    });
    Ok(variants.collect())
}

/// Mitsuba's render tests: `NAME_INTEGRATOR.xml` beside a reference. Scenes for `volpath` are also
/// rendered with `volpathmis`.
fn suite_cases(scene: PathBuf) -> Vec<Case> {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let Some((name, integrator)) = stem.rsplit_once('_') else { return Vec::new() };
    let reference = scene.with_file_name("refs").join(format!("{name}_ref_rgb.exr"));
    if !reference.is_file() {
        return Vec::new();
    }
    let integrators: &[&str] =
        if integrator == "volpath" { &["volpath", "volpathmis"] } else { &[integrator] };
    let case = |integrator: &&str| Case {
        name: format!("suite/{name} {integrator}"),
        scene: scene.clone(),
        options: options(&["-D", "spp=4", "-D", &format!("integrator={integrator}")]),
    };
    integrators.iter().map(case).collect()
}

/// Collects the scene files in a folder recursively, sorted by name.
fn find_scenes(folder: &Path, depth: u32, files: &mut Vec<PathBuf>) {
    for path in sorted_entries(folder) {
        if path.is_dir() && depth > 0 {
            find_scenes(&path, depth - 1, files);
        } else if path.extension().is_some_and(|extension| extension == "xml") {
            files.push(path);
        }
    }
}

/// The entries of a folder, sorted by name; empty if the folder does not exist.
fn sorted_entries(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scenes_of_the_repository_are_found() {
        let all = all(Path::new("nowhere")).unwrap();
        let count = |start: &str| all.iter().filter(|case| case.name.starts_with(start)).count();
        assert!(count("scenes/") >= 9 && count("tests/") >= 60);
        assert!(all.iter().all(|case| case.scene.is_file()));
    }
}
