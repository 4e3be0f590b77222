//! Broken scenes, each named after its defect, and the places at which they are refused.

use std::path::Path;
use std::time::{Duration, Instant};

use etendue_document::Fault::{BadValue, Io, Limit, MissingParameter, Syntax, Unsupported};
use etendue_document::Severity::{Error, Warning};
use etendue_document::{Diagnostics, Fault, MemoryResources, Severity, Span};
use etendue_mitsuba::{LoadOptions, read_file};

/// A file and everything that is to be said about it, by line.
struct Case {
    name: &'static str,
    bytes: &'static [u8],
    findings: &'static [(Severity, Fault, usize)],
}

macro_rules! case {
    ($name:literal, $findings:expr) => {
        Case {
            name: concat!($name, ".xml"),
            bytes: include_bytes!(concat!("../corpus/", $name, ".xml")),
            findings: $findings,
        }
    };
}

/// Line 0 stands for the first line of a file whose text cannot be shown.
static CASES: &[Case] = &[
    case!("alias_cycle", &[(Error, BadValue, 2), (Error, BadValue, 3)]),
    case!("angle_in_attribute", &[(Error, Syntax, 2)]),
    case!(
        "bad_numbers",
        &[
            (Error, BadValue, 3),
            (Error, BadValue, 4),
            (Error, BadValue, 5),
            (Error, BadValue, 6),
            (Error, BadValue, 7),
            (Error, BadValue, 8),
            (Error, BadValue, 9),
            (Error, BadValue, 10),
            (Error, BadValue, 11),
        ]
    ),
    case!("binary", &[(Error, Syntax, 1)]),
    case!("blank", &[(Error, Syntax, 1)]),
    case!("default_bomb", &[(Error, Limit, 8)]),
    case!("degenerate_lookat", &[(Error, BadValue, 4)]),
    case!("duplicate_attribute", &[(Error, Syntax, 2)]),
    case!("duplicate_ids", &[(Error, BadValue, 3)]),
    case!("empty", &[(Error, Syntax, 1)]),
    case!("entity_bomb", &[(Error, Unsupported, 2)]),
    case!("external_entity", &[(Error, Unsupported, 1)]),
    case!("include_itself", &[(Error, Syntax, 2)]),
    case!("invalid_utf8", &[(Warning, Syntax, 2)]),
    case!("late_default", &[(Error, BadValue, 2)]),
    case!("lone_ampersand", &[(Error, Syntax, 2)]),
    case!("mismatched_tags", &[(Error, Syntax, 3)]),
    case!("missing_include", &[(Error, Io, 2)]),
    case!("missing_type", &[(Error, MissingParameter, 2)]),
    case!("misspelt_element", &[(Error, Syntax, 2)]),
    case!("nested_scene", &[(Error, Syntax, 2)]),
    case!("newer_version", &[(Warning, Unsupported, 1)]),
    case!("no_element", &[(Error, Syntax, 3)]),
    case!("nonsense_version", &[(Warning, BadValue, 1)]),
    case!("plain_text", &[(Error, Syntax, 1)]),
    case!("reference_cycle", &[(Error, BadValue, 6)]),
    case!(
        "several_errors",
        &[
            (Error, BadValue, 3),
            (Error, Syntax, 5),
            (Error, BadValue, 8),
            (Error, BadValue, 10),
            (Error, Io, 12),
            (Error, BadValue, 13),
        ]
    ),
    case!("short_matrix", &[(Error, BadValue, 4)]),
    case!("singular_matrix", &[(Warning, BadValue, 3)]),
    case!("truncated_element", &[(Error, Syntax, 2)]),
    case!("truncated_tag", &[(Error, Syntax, 3)]),
    case!("truncated_value", &[(Error, Syntax, 3)]),
    case!("two_roots", &[(Warning, Syntax, 2)]),
    case!("undefined_name", &[(Error, BadValue, 3)]),
    case!("unknown_entity", &[(Error, Syntax, 2)]),
    case!("unknown_reference", &[(Error, BadValue, 3)]),
    case!("unquoted_attribute", &[(Error, Syntax, 2)]),
    case!("utf16", &[(Warning, Syntax, 1)]),
    case!("wrong_root", &[(Error, Syntax, 2)]),
    case!("zero_matrix", &[(Error, BadValue, 4)]),
];

/// Loads bytes as a file; the findings by severity, fault and line.
fn findings(name: &str, bytes: &[u8]) -> (Vec<(Severity, Fault, usize)>, Diagnostics) {
    let resources = MemoryResources::default().with(format!("/corpus/{name}"), bytes);
    let diagnostics = Diagnostics::new();
    let path = format!("/corpus/{name}");
    let _ = read_file(Path::new(&path), &resources, &LoadOptions::default(), &diagnostics);
    let text = String::from_utf8_lossy(bytes);
    let line = |span: Option<Span>| {
        let start = span.expect("it has a place").range().start;
        1 + text.bytes().take(start).filter(|byte| *byte == b'\n').count()
    };
    let found = diagnostics.sorted();
    (found.iter().map(|f| (f.severity, f.fault, line(f.span))).collect(), diagnostics)
}

#[test]
fn every_defect_is_refused_at_its_place() {
    for case in CASES {
        let (found, diagnostics) = findings(case.name, case.bytes);
        let messages: Vec<_> = diagnostics.sorted().into_iter().map(|f| f.message).collect();
        assert_eq!(found, case.findings, "{}: {messages:#?}", case.name);
    }
}

#[test]
fn the_whole_corpus_is_tested() {
    let tested: Vec<&str> = CASES.iter().map(|case| case.name).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(name == "old_dialect.xml" || tested.contains(&name.as_str()), "{name}");
    }
}

/// Files too large to keep, by their defect, with the line at which they are refused.
fn huge() -> Vec<(&'static str, String, (Severity, Fault, usize))> {
    let scene = |content: String| format!("<scene version='3.0.0'>\n{content}\n</scene>");
    let attributes = (0..100_000).map(|index| format!(" a{index}='1'")).collect::<String>();
    let namespaces = (0..50_000).map(|i| format!("<b xmlns:n{i}='u'/>")).collect::<String>();
    vec![
        ("nested elements", scene("<bsdf type='x'>".repeat(200_000)), (Error, Limit, 2)),
        (
            "nested and closed elements",
            scene("<bsdf type='x'>".repeat(200_000) + &"</bsdf>".repeat(200_000)),
            (Error, Limit, 2),
        ),
        ("attributes", scene(format!("<shape{attributes}/>")), (Error, Limit, 2)),
        ("namespaces", scene(namespaces), (Error, Limit, 2)),
        (
            "unclosed quote",
            scene("<shape type='".to_owned() + &"x".repeat(1 << 20)),
            (Error, Syntax, 2),
        ),
        ("opening brackets", "<".repeat(1 << 20), (Error, Syntax, 1)),
        ("open comments", scene("<!--".repeat(1 << 18)), (Error, Syntax, 3)),
    ]
}

/// Far above what these cases take on a busy machine. It catches time that grows with the square of the
/// input, which would be minutes; speed is for benchmarks to measure.
const TIME_LIMIT: Duration = Duration::from_secs(30);

#[test]
fn huge_defects_are_refused_soon() {
    for (name, text, expected) in huge() {
        let start = Instant::now();
        let (found, diagnostics) = findings("huge.xml", text.as_bytes());
        let seconds = start.elapsed();
        let messages: Vec<_> = diagnostics.sorted().into_iter().map(|f| f.message).collect();
        assert_eq!(found, [expected], "{name}: {messages:#?}");
        assert!(seconds < TIME_LIMIT, "{name} took {seconds:?}");
    }
}

#[test]
fn a_file_of_nothing_but_errors_ends_soon() {
    let text = format!("<scene version='3.0.0'>\n{}</scene>", "<x a='1' b='$c'/>".repeat(300_000));
    let start = Instant::now();
    let (found, diagnostics) = findings("errors.xml", text.as_bytes());
    assert!(start.elapsed() < TIME_LIMIT, "{:?}", start.elapsed());
    assert!(found.len() >= 500 && diagnostics.has_errors());
}

#[test]
fn what_is_shown_for_each_case_holds_its_file_and_line() {
    for case in CASES {
        let resources = MemoryResources::default().with(case.name, case.bytes);
        let diagnostics = Diagnostics::new();
        let options = LoadOptions::default();
        let sources = match read_file(Path::new(case.name), &resources, &options, &diagnostics) {
            Ok(document) => document.sources,
            Err(sources) => sources,
        };
        let found = diagnostics.sorted().into_iter();
        let shown: String = found
            .map(|f| {
                etendue_document::render_diagnostic(
                    &f,
                    &sources,
                    etendue_document::ExcerptStyle::default(),
                )
            })
            .collect();
        for (_, _, line) in case.findings {
            assert!(shown.contains(&format!("{}:{line}:", case.name)), "{shown}");
        }
    }
}

#[test]
fn many_unknown_ids_among_many_known_ones_end_soon() {
    let known: String = (0..20_000).map(|i| format!("<shape type='s' id='near{i}'/>")).collect();
    let unknown = (0..20_000).map(|i| format!("<ref id='naer{i}'/>")).collect::<String>();
    let text = format!("<scene version='3.0.0'>{known}{unknown}</scene>");
    let start = Instant::now();
    let (_, diagnostics) = findings("ids.xml", text.as_bytes());
    assert!(start.elapsed() < TIME_LIMIT, "{:?}", start.elapsed());
    assert_eq!(diagnostics.error_count(), 20_000);
}
