//! Mistakes that fit on one line of a scene.

use crate::case::{Case, Parts};

/// The rows of `elements.txt`.
fn cases() -> Vec<Case> {
    let mut heading = "";
    let mut cases = Vec::new();
    for row in include_str!("elements.txt").lines().filter(|row| !row.is_empty()) {
        if row.starts_with('#') {
            continue;
        }
        if let Some(name) = row.strip_prefix('[') {
            heading = name.trim_end_matches(']');
            continue;
        }
        let (message, text) = row.split_once(" | ").expect("a message, a bar and a text");
        cases.push(case(heading, message, text));
    }
    cases
}

fn case(heading: &str, message: &str, text: &str) -> Case {
    let default = Parts::default();
    let (parts, line) = match heading {
        "sensor" => (Parts { sensor: text, ..default }, 2),
        "film" => (Parts { film: text, ..default }, 3),
        "sampler" => (Parts { sampler: text, ..default }, 4),
        "scene" => (Parts { content: text, ..default }, 7),
        other => panic!("no heading [{other}]"),
    };
    Case { scene: parts.scene().into_bytes(), line: Some(line), ..Case::content(text, message) }
}

#[test]
fn every_mistake_is_reported_at_its_line() {
    let cases = cases();
    assert!(cases.len() >= 90, "the table has too few rows: {}", cases.len());
    cases.iter().for_each(Case::check);
}

#[test]
fn strict_mode_treats_unknown_parameters_as_errors() {
    let content = r#"<bsdf type="diffuse"><rgb name="reflektance" value="1, 1, 1"/></bsdf>"#;
    let case = Case::content(content, "no parameter `reflektance`");
    Case { arguments: &["--strict"], ..case }.check();
}
