//! Broken input gives a clear error with its place and exit code 2, within seconds and in little
//! memory.

use std::fs;
use std::time::{Duration, Instant};

use crate::run::{Outcome, Workplace, binary, test_file};

/// One scene of the folder `broken`.
struct Case {
    name: String,
    /// The line that the first error points at; `None` if it has no place.
    line: Option<String>,
    message: String,
}

fn cases() -> Vec<Case> {
    let table = fs::read_to_string(test_file("broken/expected.txt")).unwrap();
    let rows = table.lines().filter(|line| !line.starts_with('#'));
    let case = |row: &str| {
        let (name, rest) = row.split_once(' ').unwrap();
        let (line, message) = rest.trim_start().split_once("  ").unwrap();
        Case {
            name: name.to_owned(),
            line: Some(line.to_owned()).filter(|line| line != "-"),
            message: message.to_owned(),
        }
    };
    rows.map(case).collect()
}

/// Renders a broken scene and checks what all broken scenes have in common.
fn render_broken(scene: &str, line: Option<&str>, message: &str) -> Outcome {
    let started = Instant::now();
    let outcome = Workplace::new().fail(&["render", scene, "-t", "2"]);
    assert!(started.elapsed() < Duration::from_secs(20), "{scene} took too long");
    let first = outcome.stderr.split("error: ").nth(1).unwrap();
    assert!(first.contains(message), "{scene}: {}", outcome.stderr);
    if let Some(line) = line {
        let file = scene.rsplit('/').next().unwrap();
        let place = format!("{file}:{line}:");
        assert!(first.contains(&place), "{scene}: {}", outcome.stderr);
        assert!(first.contains('^') || first.contains('╭'), "no caret: {}", outcome.stderr);
    }
    outcome
}

#[test]
fn every_broken_scene_is_rejected_at_the_right_place() {
    let cases = cases();
    assert!(cases.len() >= 60);
    for case in &cases {
        // The error in a loop of includes may name any file of the loop.
        let (scene, line) = match case.name.as_str() {
            "include_loop_a" | "include_loop_b" => ("include_loop", None),
            name => (name, case.line.as_deref()),
        };
        let path = test_file(&format!("broken/{}.xml", case.name));
        let outcome = render_broken(&path, line, &case.message);
        assert!(outcome.stderr.contains(scene), "{}", outcome.stderr);
    }
}

#[test]
fn the_table_names_every_broken_scene() {
    let mut named: Vec<String> = cases().into_iter().map(|case| case.name + ".xml").collect();
    let entries = fs::read_dir(test_file("broken")).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut scenes: Vec<String> = names.filter(|name| name.ends_with(".xml")).collect();
    named.sort();
    scenes.sort();
    assert_eq!(named, scenes);
}

#[test]
fn one_run_reports_several_errors() {
    let scene = test_file("broken/many_errors.xml");
    let outcome = Workplace::new().fail(&["render", &scene]);
    for message in ["`spherre`", "`one`", "`gold`", "3 errors, 0 warnings"] {
        assert!(outcome.stderr.contains(message), "{message}: {}", outcome.stderr);
    }
}

/// Scenes that are too large to store as files.
#[test]
fn large_broken_scenes_are_rejected() {
    let workplace = Workplace::new();
    let head = "<scene version=\"3.0.0\">\n";
    let nested = ["<bsdf type=\"twosided\">".repeat(200_000), "</bsdf>".repeat(200_000)].concat();
    let attributes: String = (0..20_000).map(|index| format!(" a{index}=\"1\"")).collect();
    let cases = [
        ("nested.xml", format!("{head}{nested}</scene>"), "deep"),
        ("attributes.xml", format!("{head}<shape{attributes}/></scene>"), "attributes"),
        ("open.xml", format!("{head}{}", "<bsdf>".repeat(1_000_000)), "deep"),
        ("errors.xml", format!("{head}{}</scene>", "<shap/>\n".repeat(100_000)), "<shap>"),
        ("comment.xml", format!("{head}<!-- {}", "- ".repeat(1_000_000)), "comment"),
    ];
    for (name, text, message) in cases {
        fs::write(workplace.path(name), text).unwrap();
        let scene = workplace.path(name);
        render_broken(scene.to_str().unwrap(), None, message);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn sizes_announced_by_headers_allocate_no_memory() {
    let scenes = [
        "ply_promises_4e9",
        "ply_huge_list",
        "serialized_promises",
        "png_huge",
        "hdr_broken",
        "huge_film",
        "large_film",
        "default_bomb",
        "entity_bomb",
    ];
    for name in scenes {
        let workplace = Workplace::new();
        let scene = test_file(&format!("broken/{name}.xml"));
        let binary = binary().display().to_string();
        // Half a gigabyte of address space; an allocation beyond it would abort the process.
        let script = format!("ulimit -v 524288; exec '{binary}' render '{scene}' -t 2");
        let mut command = std::process::Command::new("sh");
        command.args(["-c", &script]).current_dir(workplace.path(""));
        let outcome = Outcome::from(command.output().unwrap());
        assert_eq!(outcome.code, Some(2), "{name}: {}", outcome.stderr);
    }
}

#[test]
fn devices_and_folders_are_rejected() {
    let workplace = Workplace::new();
    for path in [".", "/dev/zero", "nowhere.xml", ""] {
        if path != "/dev/zero" || cfg!(unix) {
            workplace.fail(&["render", path]);
        }
    }
}
