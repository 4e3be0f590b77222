//! `etendue check` and `etendue info`, and their diagnostics.

use std::process::Stdio;

use crate::run::{Workplace, small_scene, test_file};

fn warnings_scene() -> String {
    test_file("scenes/warnings.xml")
}

#[test]
fn check_reports_everything_and_renders_nothing() {
    let workplace = Workplace::new();
    let fine = workplace.succeed(&["check", &small_scene()]);
    assert!(fine.stdout.ends_with("small.xml: 0 errors, 0 warnings\n"), "{}", fine.stdout);
    assert_eq!(fine.stderr, "");
    let broken = workplace.run(&["check", &small_scene(), &test_file("broken/many_errors.xml")]);
    assert_eq!(broken.code, Some(2));
    assert!(
        broken.stdout.ends_with("many_errors.xml: 3 errors, 0 warnings\n"),
        "{}",
        broken.stdout
    );
    assert!(broken.stderr.contains("many_errors.xml:8:52"), "{}", broken.stderr);
    assert_eq!(workplace.files(), [""; 0]);
}

#[test]
fn each_warning_is_shown_once_with_its_place_and_similar_names() {
    let outcome = Workplace::new().succeed(&["check", &warnings_scene(), "--skip-missing"]);
    assert!(
        outcome.stdout.contains("0 errors, 3 warnings"),
        "{}{}",
        outcome.stdout,
        outcome.stderr
    );
    for (message, place) in [("bdpt", ":2:"), ("fovv", ":4:"), ("nowhere.obj", ":9:")] {
        let place = format!("warnings.xml{place}");
        assert!(outcome.stderr.contains(message), "{message}: {}", outcome.stderr);
        assert_eq!(outcome.stderr.matches(&place).count(), 1, "{place}: {}", outcome.stderr);
    }
    assert!(outcome.stderr.contains("`fov`"), "the similar name: {}", outcome.stderr);
}

#[test]
fn missing_files_and_strict_mode_give_errors() {
    let workplace = Workplace::new();
    let missing = workplace.fail(&["check", &warnings_scene()]);
    assert!(missing.stdout.contains("1 error, 2 warnings"), "{}", missing.stdout);
    let strict = workplace.fail(&["check", &warnings_scene(), "--skip-missing", "--strict"]);
    assert!(strict.stdout.contains("1 error, 2 warnings"), "{}", strict.stdout);
    assert!(strict.stderr.contains("error: "), "{}", strict.stderr);
}

#[test]
fn quiet_keeps_errors_and_drops_warnings() {
    let outcome = Workplace::new().fail(&["check", &warnings_scene(), "-q"]);
    assert!(outcome.stderr.contains("nowhere.obj") && !outcome.stderr.contains("fovv"));
    assert_eq!(outcome.stdout, "");
}

#[test]
fn info_counts_the_objects_of_a_scene() {
    let outcome = Workplace::new().succeed(&["info", &small_scene()]);
    for row in ["shapes     2\n", "triangles  2\n", "emitters   1 constant", "`side`: 20x20"] {
        assert!(outcome.stdout.contains(row), "{row}: {}", outcome.stdout);
    }
}

#[test]
fn info_without_a_scene_shows_the_program() {
    let outcome = Workplace::new().succeed(&["info", "-t", "3"]);
    let names = outcome.stdout.lines().map(|line| line.split(' ').next().unwrap());
    assert!(names.eq(["version", "target", "simd", "threads"]), "{}", outcome.stdout);
    assert!(outcome.stdout.contains("threads    3\n"), "{}", outcome.stdout);
    let outcome = Workplace::new().succeed(&["info", "--json"]);
    let info: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    let version = info["program"]["version"].as_str().unwrap();
    assert!(version.starts_with(env!("CARGO_PKG_VERSION")), "{version}");
}

#[test]
fn info_prints_json() {
    let workplace = Workplace::new();
    let outcome = workplace.succeed(&["info", &small_scene(), "--json"]);
    let info: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(info["shapes"], 2);
    assert_eq!(info["sensors"][1]["id"], "side");
    let bottom = info["bounds"]["min"][1].as_f64().unwrap();
    assert!((bottom + 1.0).abs() < 1e-6, "a rotated rectangle is flat within rounding");
    let warned = workplace.succeed(&["info", &warnings_scene(), "--json", "--skip-missing", "-q"]);
    let info: serde_json::Value = serde_json::from_str(&warned.stdout).unwrap();
    assert_eq!(info["findings"][0]["place"]["line"], 2);
    workplace.fail(&["info", &test_file("broken/empty.xml")]);
}

/// The volume has 40 × 64 × 40 values, and bounds for 10 × 16 × 10 blocks.
#[test]
fn info_shows_media_and_the_memory_of_their_volumes() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/smoke/scene.xml");
    let outcome = Workplace::new().succeed(&["info", scene, "--json"]);
    let info: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(info["media"], 1);
    assert_eq!(info["memory_bytes"]["volumes"], 4 * (40 * 64 * 40 + 10 * 16 * 10));
}

#[test]
fn arguments_that_do_not_fit_say_what_to_write() {
    let workplace = Workplace::new();
    for (arguments, words) in [
        (["--integrator", "bdpt"], "did you mean `path`?"),
        (["--integrator", "volpaht"], "did you mean `volpath`"),
        (["-D", "${spp}=4"], "write -D spp=4"),
    ] {
        let outcome = workplace.run(&["check", &small_scene(), arguments[0], arguments[1]]);
        assert_eq!(outcome.code, Some(2));
        assert!(outcome.stderr.contains(words), "{}", outcome.stderr);
        assert!(!outcome.stderr.contains("`depth`"), "{}", outcome.stderr);
    }
}

#[test]
fn unknown_plugins_are_replaced_only_if_asked_for() {
    let workplace = Workplace::new();
    let scene = r#"<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/>
        <shape type="sphere"><bsdf type="homemade"/></shape></scene>"#;
    std::fs::write(workplace.path("scene.xml"), scene).unwrap();
    let refused = workplace.run(&["check", "scene.xml"]);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    for command in ["check", "info"] {
        let lenient = workplace.succeed(&[command, "scene.xml", "--lenient"]);
        assert_eq!(lenient.stderr.matches("`homemade`").count(), 1, "{}", lenient.stderr);
    }
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let workplace = Workplace::new();
    let mut command = workplace.command(&["info", &small_scene()]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}
