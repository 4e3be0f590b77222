//! The table of Mitsuba 0.6 on the coverage page: what becomes of each plugin. Their list is a file;
//! the answers come from reading a scene with each plugin.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use etendue::document::{Diagnostics, Document, MemoryResources};
use etendue::mitsuba::{LoadOptions, read_text};
use etendue::{integrators, scene};

/// Mitsuba 0.6's plugins; the head of the file explains its format.
const THEIRS: &str = include_str!("mitsuba06.txt");

/// The section, with one row for each plugin.
pub(super) fn section() -> String {
    let ours = scene::registry::plugins().into_iter().chain(integrators::plugins());
    let known: BTreeSet<(&str, &str)> = ours.map(|(class, name, _)| (class.name(), name)).collect();
    let mut section = "\n# Mitsuba 0.6, plugin by plugin\n\n\
        What becomes of the plugins of version 0.6. What is not simply the same is said when a scene is \
        loaded, in the words of this table; [Older versions](scene-format.md#older-versions) has the \
        parameters.\n\n| class | plugin | here |\n|---|---|---|\n"
        .to_owned();
    for line in THEIRS.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let Some((head, inner)) = line.split_once(':') else { continue };
        let Some((class, name)) = head.split_once(' ') else { continue };
        let fate = fate(&known, class, name, inner);
        let _ = writeln!(section, "| {class} | `{name}` | {fate} |");
    }
    section
}

/// What becomes of a plugin, in words.
fn fate(known: &BTreeSet<(&str, &str)>, class: &str, name: &str, inner: &str) -> String {
    let element = format!("<{class} type=\"{name}\">{inner}</{class}>");
    let element = match class {
        "subsurface" => format!("<shape type=\"sphere\">{element}</shape>"),
        _ => element,
    };
    let text = format!("<scene version=\"0.6.0\">{element}</scene>");
    let (files, diagnostics) = (MemoryResources::default(), Diagnostics::new());
    let document = read_text(&text, &files, &LoadOptions::default(), &diagnostics).ok();
    let said: Vec<String> =
        diagnostics.sorted().into_iter().map(|finding| finding.message).collect();
    if !said.is_empty() {
        return said.join("; ");
    }
    match document.as_ref().and_then(first_plugin) {
        Some(same) if same == name && known.contains(&(class, name)) => "the same".to_owned(),
        Some(other) if known.contains(&(class, other)) => format!("`{other}`"),
        _ => "**not here**".to_owned(),
    }
}

/// The plugin of the first object of a scene.
fn first_plugin(document: &Document) -> Option<&str> {
    let first = document.node(document.root).children.first()?;
    Some(document.node(first.node).plugin.as_str())
}
