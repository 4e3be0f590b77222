//! Input that expands to a much larger size.

use crate::case::Case;

fn repeat(count: usize, text: impl Fn(usize) -> String) -> String {
    (0..count).map(text).collect()
}

#[test]
fn input_that_grows_without_bound_is_rejected() {
    let long = "x".repeat(10_000_000);
    let cases = [
        (format!("<shape type=\"{long}\"/>"), "unknown shape `xxx"),
        (format!("<shape type=\"sphere\"><ref id=\"{long}\"/></shape>"), "id `xxx"),
        (format!("<shape {}/>", repeat(100_000, |i| format!("a{i}=\"1\" "))), "attributes"),
        (format!("<{}", "<".repeat(1_000_000)), "name"),
        ("&".repeat(1_000_000), "`&`"),
        (
            format!("<bsdf type=\"diffuse\"><string name=\"{long}\" value=\"\"/><x/></bsdf>"),
            "`<x>`",
        ),
        (doubling_defaults(60), "`$names`"),
        (doubling_references(60), "1000000 objects"),
        (format!("<shape type=\"sphere\">{}</shape>", matrix(1_000_000)), "not 1000000"),
        (
            format!("<path value=\"a\"/>{}", repeat(200, |i| format!("<path value=\"b{i}\"/>"))),
            "100 `<path>`",
        ),
        (
            repeat(60, |_| "<integrator type=\"moment\">".into()) + &"</integrator>".repeat(60),
            "too deeply",
        ),
    ];
    for (content, message) in cases {
        Case::content(&content, message).check();
    }
}

fn matrix(count: usize) -> String {
    format!("<transform name=\"to_world\"><matrix value=\"{}\"/></transform>", "1 ".repeat(count))
}

/// Each name expands to the previous one twice.
fn doubling_defaults(count: usize) -> String {
    let double = |i: usize| format!("<default name=\"v{}\" value=\"$v{i}$v{i}\"/>", i + 1);
    format!("<default name=\"v0\" value=\"a\"/>{}", repeat(count, double))
}

/// Each material contains the next one twice.
fn doubling_references(count: usize) -> String {
    let double = |i: usize| {
        let next = i + 1;
        format!(
            "<bsdf type=\"blendbsdf\" id=\"b{i}\"><ref id=\"b{next}\"/><ref id=\"b{next}\"/></bsdf>"
        )
    };
    format!("{}<bsdf type=\"diffuse\" id=\"b{count}\"/>", repeat(count, double))
}

/// A valid film that exceeds the available memory.
#[test]
#[cfg(target_os = "linux")]
fn a_film_larger_than_memory_is_rejected_before_allocation() {
    let case = Case::content("", "needs");
    Case { line: None, arguments: &["--size", "16384x16384"], ..case }.check();
}

#[test]
fn a_thousand_missing_files_are_reported_in_time() {
    let shape =
        |i| format!("<shape type=\"obj\"><string name=\"filename\" value=\"{i:04}.obj\"/></shape>");
    let case = Case::content(&repeat(1000, shape), "no file `0000.obj`");
    let mut files = Vec::new();
    // Similar names, which the search for suggestions compares.
    let names: &[&str] = &["0000.ply", "0001.ply", "0002.ply"];
    files.extend(names.iter().map(|name| (*name, Vec::new())));
    Case { files, ..case }.check();
}
