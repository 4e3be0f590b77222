//! Every example runs and produces the expected output.
#![allow(clippy::disallowed_methods, reason = "tests write scene files and read pictures")]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const SCENE: &str = r#"<scene version="3.0.0">
    <integrator type="path"/>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="12"/></film>
        <sampler type="independent"><integer name="sample_count" value="4"/></sampler>
    </sensor>
    <emitter type="constant"/>
    <shape type="sphere"><bsdf type="roughconductor"><float name="alpha" value="0.2"/></bsdf></shape>
</scene>"#;

/// `cargo test` builds a package's examples along with its tests, into a folder beside theirs. It
/// does not if `--test` selects only this test: run `cargo build --examples` first.
fn example(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("a test is a file");
    let profile = test.parent().and_then(Path::parent).expect("target/PROFILE/deps/TEST");
    let program = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    let path = profile.join("examples").join(program);
    assert!(path.exists(), "{} has not been built: see `cargo build --examples`", path.display());
    path
}

/// The output of an example run in a folder that holds `scene.xml`.
fn run(name: &str, arguments: &[&str], folder: &Path) -> String {
    std::fs::write(folder.join("scene.xml"), SCENE).unwrap();
    let output = Command::new(example(name))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {errors}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[test]
fn every_example_has_its_test() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut names: Vec<String> =
        files.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    names.sort();
    assert_eq!(names, ["bsdf", "bvh", "edit", "progress", "render_file", "scene_from_code"]);
}

#[test]
fn render_file_writes_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let shown = run("render_file", &["scene.xml", "a.png", "2"], folder.path());
    assert!(shown.starts_with("384 samples in "), "{shown}");
    let bytes = std::fs::read(folder.path().join("a.png")).unwrap();
    let picture = etendue::image::decode_picture(&bytes, "a.png").unwrap();
    assert_eq!((picture.width, picture.height), (16, 12));
}

#[test]
fn progress_renders_until_the_time_is_over() {
    let folder = tempfile::tempdir().unwrap();
    let shown = run("progress", &["scene.xml", "0.05"], folder.path());
    assert!(shown.ends_with("samples per pixel\n"), "{shown}");
}

#[test]
fn bvh_finds_the_sphere() {
    let folder = tempfile::tempdir().unwrap();
    let shown = run("bvh", &[], folder.path());
    assert!(shown.contains("at distance 2.02"), "{shown}");
    assert!(shown.contains("occluded: false"), "{shown}");
    assert!(shown.contains("0.78"), "{shown}");
}

#[test]
fn bsdf_reflects_most_of_the_red_light() {
    let folder = tempfile::tempdir().unwrap();
    let shown = run("bsdf", &[], folder.path());
    assert!(shown.contains("albedo: [0.9"), "{shown}");
}

#[test]
fn scene_from_code_writes_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    run("scene_from_code", &[], folder.path());
    let bytes = std::fs::read(folder.path().join("octahedron.png")).unwrap();
    let picture = etendue::image::decode_picture(&bytes, "octahedron.png").unwrap();
    assert_eq!((picture.width, picture.height), (320, 240));
}

#[test]
fn edit_times_what_the_scene_has() {
    let folder = tempfile::tempdir().unwrap();
    let shown = run("edit", &["scene.xml"], folder.path());
    let names: Vec<&str> =
        shown.lines().map(|line| line.split("  ").next().unwrap_or_default()).collect();
    let expected = ["first load", "nothing", "sensor", "film", "sampler", "bsdf"];
    assert_eq!(names[..6], expected, "{shown}");
    assert_eq!(names[6..], ["emitter added", "shape removed"], "{shown}");
}
