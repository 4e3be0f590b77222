//! `cargo xtask deps`: checks that a crate uses only the crates that its row lists.

use serde_json::Value;

use crate::workspace::cargo;

/// The workspace crates that a crate may use in its code, and additionally in its tests.
struct Row {
    name: &'static str,
    uses: &'static [&'static str],
    tests_use: &'static [&'static str],
}

/// The layers, lowest first. A row names only rows above it; tests may use any crate.
const TABLE: &[Row] = &[
    Row { name: "etendue-math", uses: &[], tests_use: &["etendue-testkit"] },
    Row { name: "etendue-testkit", uses: &["etendue-math"], tests_use: &[] },
    Row { name: "etendue-sampling", uses: &["etendue-math"], tests_use: &["etendue-testkit"] },
    Row { name: "etendue-spectrum", uses: &["etendue-math"], tests_use: &["etendue-testkit"] },
    Row { name: "etendue-image", uses: &["etendue-math"], tests_use: &["etendue-testkit"] },
    Row { name: "etendue-mesh", uses: &["etendue-math"], tests_use: &["etendue-testkit"] },
    Row { name: "etendue-bvh", uses: &["etendue-math"], tests_use: &["etendue-testkit"] },
    Row { name: "etendue-document", uses: &["etendue-math"], tests_use: &["etendue-testkit"] },
    Row {
        name: "etendue-mitsuba",
        uses: &["etendue-math", "etendue-document"],
        tests_use: &["etendue-testkit"],
    },
    Row {
        name: "etendue-scene",
        uses: LAYERS_0_AND_1,
        tests_use: &["etendue-testkit", "etendue-mitsuba"],
    },
    Row {
        name: "etendue-integrators",
        uses: &[
            "etendue-scene",
            "etendue-math",
            "etendue-sampling",
            "etendue-spectrum",
            "etendue-document",
        ],
        tests_use: &["etendue-testkit", "etendue-mitsuba"],
    },
    Row {
        name: "etendue-engine",
        uses: &[
            "etendue-integrators",
            "etendue-scene",
            "etendue-math",
            "etendue-sampling",
            "etendue-spectrum",
            "etendue-image",
            "etendue-document",
        ],
        tests_use: &["etendue-testkit", "etendue-mitsuba"],
    },
    Row {
        name: "etendue",
        uses: &[
            "etendue-engine",
            "etendue-integrators",
            "etendue-scene",
            "etendue-mitsuba",
            "etendue-math",
            "etendue-sampling",
            "etendue-spectrum",
            "etendue-image",
            "etendue-mesh",
            "etendue-bvh",
            "etendue-document",
        ],
        tests_use: &["etendue-testkit"],
    },
    Row { name: "etendue-cli", uses: &["etendue"], tests_use: &["etendue-testkit"] },
    Row { name: "xtask", uses: &[], tests_use: &[] },
    Row { name: "xtask-generate", uses: &["etendue"], tests_use: &[] },
];

/// The crates that do not depend on the scene.
const LAYERS_0_AND_1: &[&str] = &[
    "etendue-math",
    "etendue-sampling",
    "etendue-spectrum",
    "etendue-image",
    "etendue-mesh",
    "etendue-bvh",
    "etendue-document",
];

/// A dependency between two crates of the workspace.
#[derive(Debug, PartialEq, Eq)]
struct Edge {
    from: String,
    to: String,
    in_tests: bool,
}

/// Compares the manifests with the table; prints every violation.
pub(crate) fn run(_arguments: &[String]) -> bool {
    let problems = match read_edges() {
        Ok((crates, edges)) => find_problems(&crates, &edges),
        Err(error) => vec![error],
    };
    for problem in &problems {
        eprintln!("{problem}");
    }
    problems.is_empty()
}

/// The crates of the workspace and the edges between them, from their manifests.
fn read_edges() -> Result<(Vec<String>, Vec<Edge>), String> {
    let output = cargo()
        .args(["metadata", "--format-version", "1", "--no-deps"])
        .output()
        .map_err(|error| format!("cannot run cargo metadata: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let metadata: Value = serde_json::from_slice(&output.stdout)
        .map_err(|error| format!("cargo metadata is no JSON: {error}"))?;
    Ok(parse_edges(&metadata))
}

fn parse_edges(metadata: &Value) -> (Vec<String>, Vec<Edge>) {
    let empty = Vec::new();
    let packages = metadata["packages"].as_array().unwrap_or(&empty);
    let name = |value: &Value| value["name"].as_str().unwrap_or_default().to_owned();
    let crates: Vec<String> = packages.iter().map(name).collect();
    let mut edges = Vec::new();
    for package in packages {
        for dependency in package["dependencies"].as_array().unwrap_or(&empty) {
            // Only crates of the workspace have a path.
            if dependency["path"].is_string() {
                let in_tests = dependency["kind"] == "dev";
                edges.push(Edge { from: name(package), to: name(dependency), in_tests });
            }
        }
    }
    (crates, edges)
}

fn find_problems(crates: &[String], edges: &[Edge]) -> Vec<String> {
    let row = |name: &str| TABLE.iter().find(|row| row.name == name);
    let unknown = crates.iter().filter(|name| row(name).is_none());
    let unknown = unknown.map(|name| format!("crate {name} has no row in the table"));
    let is_allowed = |edge: &&Edge| {
        row(&edge.from).is_none_or(|row| {
            let to = edge.to.as_str();
            row.uses.contains(&to) || (edge.in_tests && row.tests_use.contains(&to))
        })
    };
    let forbidden = edges.iter().filter(|edge| !is_allowed(edge)).map(|edge| {
        let Edge { from, to, in_tests } = edge;
        let place = if *in_tests { " in its tests" } else { "" };
        format!("{from} may not use {to}{place}")
    });
    unknown.chain(forbidden).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(from: &str, to: &str, kind: Option<&str>) -> Vec<String> {
        let metadata = serde_json::json!({ "packages": [{
            "name": from,
            "dependencies": [
                { "name": to, "kind": kind, "path": "/somewhere" },
                { "name": "glam", "kind": null },
            ],
        }] });
        let (crates, edges) = parse_edges(&metadata);
        find_problems(&crates, &edges)
    }

    #[test]
    fn edges_of_the_table_pass_and_others_do_not() {
        assert!(edge("etendue-engine", "etendue-integrators", None).is_empty());
        let upwards = edge("etendue-math", "etendue-scene", None);
        assert_eq!(upwards, ["etendue-math may not use etendue-scene"]);
        assert_eq!(edge("etendue-new", "etendue-math", None).len(), 1);
    }

    #[test]
    fn tests_may_use_more() {
        assert!(edge("etendue-scene", "etendue-testkit", Some("dev")).is_empty());
        assert_eq!(edge("etendue-scene", "etendue-testkit", None).len(), 1);
        assert_eq!(edge("etendue-scene", "etendue-engine", Some("dev")).len(), 1);
    }

    #[test]
    fn rows_name_only_rows_above_them() {
        for (index, row) in TABLE.iter().enumerate() {
            for used in row.uses {
                let place = TABLE.iter().position(|other| other.name == *used);
                assert!(place.is_some_and(|place| place < index), "{} uses {used}", row.name);
            }
        }
    }
}
