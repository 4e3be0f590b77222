//! The page that compares the renderer with Mitsuba 3: every plugin and parameter, and how it is
//! supported here. Mitsuba's list is a file; the answers come from the code.

use std::fmt::Write as _;

use super::mitsuba06;
use etendue::document::{Diagnostics, MemoryResources};
use etendue::mitsuba::{LoadOptions, read_text};
use etendue::scene::Manual;
use etendue::{integrators, scene};

/// The path of the page.
pub(super) const PATH: &str = "docs/coverage.md";

/// Mitsuba 3's plugins; the head of the file explains its format.
const THEIRS: &str = include_str!("mitsuba3.txt");

/// A manual's description of an ignored parameter begins like this.
const WITHOUT_EFFECT: &str = "Accepted and without effect";

/// A plugin of Mitsuba.
struct Theirs {
    class: &'static str,
    name: &'static str,
    parameters: Vec<&'static str>,
}

/// How a plugin is supported here.
enum Fate {
    /// It exists here, with this page.
    Here(&'static Manual),
    /// It becomes a value of the parameter that it is nested as.
    Value,
    /// Another plugin replaces it, with this page.
    Approximated(String, &'static Manual),
    Missing,
}

/// How a parameter is supported.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Share {
    Here,
    WithoutEffect,
    Missing,
}

/// Plugins or parameters, grouped by support.
#[derive(Default)]
struct Tally {
    all: usize,
    here: usize,
    approximated: usize,
}

/// The text of the page.
pub(super) fn page() -> String {
    let (mut plugins, mut parameters) = (Tally::default(), Tally::default());
    let mut tables = String::new();
    let mut class = "";
    for theirs in parse() {
        if theirs.class != class {
            class = theirs.class;
            let _ = write!(
                tables,
                "\n## {class}\n\n| plugin | | parameters that are here | approximated | not here |\n|---|---|---|---|---|\n"
            );
        }
        let fate = fate(&theirs);
        let shares: Vec<Share> = theirs.parameters.iter().map(|name| fate.share(name)).collect();
        plugins.count(fate.as_share());
        shares.iter().for_each(|share| parameters.count(*share));
        write_row(&mut tables, &theirs, &fate, &shares);
    }
    format!(
        "# Mitsuba 3, plugin by plugin\n\n\
         <!-- Written by `cargo xtask docs`: their list is a file, what is here is asked of the code. -->\n\n\
         Every plugin of Mitsuba 3.9 and every parameter that its scene files can give it, apart from \
         those that need Python objects. *Approximated* are plugins that another one stands in for, and \
         parameters that are read and change nothing, or that a stand-in does not know. The [plugin reference](plugins.md) says what each \
         of those that are here does.\n\n\
         | | in Mitsuba | here | approximated | not here |\n|---|---|---|---|---|\n{}{}{tables}{}",
        plugins.row("plugins"),
        parameters.row("parameters"),
        mitsuba06::section(),
    )
}

/// Reads the list.
fn parse() -> Vec<Theirs> {
    let lines = THEIRS.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    let parse_line = |line: &'static str| {
        let (head, parameters) = line.split_once(':')?;
        let (class, name) = head.split_once(' ')?;
        Some(Theirs { class, name, parameters: parameters.split_whitespace().collect() })
    };
    lines.filter_map(parse_line).collect()
}

fn fate(theirs: &Theirs) -> Fate {
    let mut ours = scene::registry::plugins();
    ours.extend(integrators::plugins());
    let find = |class: &str, name: &str| {
        let same = |page: &&(etendue::document::Class, &'static str, &'static Manual)| {
            page.0.name() == class && page.1 == name
        };
        ours.iter().find(same).map(|(_, _, manual)| *manual)
    };
    if let Some(manual) = find(theirs.class, theirs.name) {
        return Fate::Here(manual);
    }
    let Some(other) = upgraded(theirs) else {
        return Fate::Value;
    };
    let manual = find(theirs.class, &other).filter(|_| other != theirs.name);
    manual.map_or(Fate::Missing, |manual| Fate::Approximated(other, manual))
}

/// The name under which a scene with the plugin reaches the renderer; `None` if it becomes a value.
fn upgraded(theirs: &Theirs) -> Option<String> {
    let Theirs { class, name, .. } = theirs;
    // Spectra need certain parameters to be recognised; the others need none.
    let inner = r#"<float name="value" value="0.5"/><rgb name="color" value="0.5"/>
        <float name="temperature" value="5000"/><string name="values" value="0.1, 0.2"/>
        <string name="wavelengths" value="400, 700"/>
        <float name="wavelength_min" value="400"/><float name="wavelength_max" value="700"/>"#;
    let element = match *class {
        "spectrum" => format!(
            "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" type=\"{name}\">{inner}</spectrum></bsdf>"
        ),
        // Wrappers need something to wrap.
        "integrator" => {
            format!("<integrator type=\"{name}\"><integrator type=\"path\"/></integrator>")
        }
        _ => format!("<{class} type=\"{name}\"/>"),
    };
    let text = format!("<scene version=\"3.0.0\">{element}</scene>");
    let (files, diagnostics) = (MemoryResources::default(), Diagnostics::new());
    let document = read_text(&text, &files, &LoadOptions::default(), &diagnostics).ok()?;
    let of_scene = &document.node(document.root).children;
    let mut node = document.node(of_scene.first()?.node);
    if *class == "spectrum" {
        node = document.node(node.children.first()?.node);
    }
    Some(node.plugin.to_string())
}

impl Fate {
    fn as_share(&self) -> Share {
        match self {
            Self::Here(_) | Self::Value => Share::Here,
            Self::Approximated(..) => Share::WithoutEffect,
            Self::Missing => Share::Missing,
        }
    }

    fn share(&self, parameter: &str) -> Share {
        // A parameter that the substitute also has keeps its meaning.
        let (manual, otherwise) = match self {
            Self::Here(manual) => (manual, Share::Missing),
            Self::Approximated(_, manual) => (manual, Share::WithoutEffect),
            other => return other.as_share(),
        };
        match manual.parameters.iter().find(|ours| ours.name == parameter) {
            Some(ours) if ours.meaning.starts_with(WITHOUT_EFFECT) => Share::WithoutEffect,
            Some(_) => Share::Here,
            None => otherwise,
        }
    }
}

impl Tally {
    fn count(&mut self, share: Share) {
        self.all += 1;
        self.here += usize::from(share == Share::Here);
        self.approximated += usize::from(share == Share::WithoutEffect);
    }

    fn row(&self, what: &str) -> String {
        let missing = self.all - self.here - self.approximated;
        let share = |count: usize| {
            format!("{count} ({:.0} %)", 100.0 * count as f64 / self.all.max(1) as f64)
        };
        let (here, approximated) = (share(self.here), share(self.approximated));
        format!("| {what} | {} | {here} | {approximated} | {} |\n", self.all, share(missing))
    }
}

fn write_row(tables: &mut String, theirs: &Theirs, fate: &Fate, shares: &[Share]) {
    let verdict = match fate {
        Fate::Here(_) | Fate::Value => "here".to_owned(),
        Fate::Approximated(other, _) => format!("approximated by `{other}`"),
        Fate::Missing => "**not here**".to_owned(),
    };
    let names = |wanted: Share| {
        let pairs = theirs.parameters.iter().zip(shares);
        let chosen = pairs.filter(|(_, share)| **share == wanted);
        chosen.map(|(name, _)| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    };
    let cells = [Share::Here, Share::WithoutEffect, Share::Missing].map(names);
    let _ = writeln!(tables, "| `{}` | {verdict} | {} |", theirs.name, cells.join(" | "));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repository::Made;

    #[test]
    fn the_committed_page_is_current() {
        let made = Made { path: PATH, bytes: page().into_bytes() };
        assert!(made.is_current(), "run `cargo xtask docs`");
    }

    #[test]
    fn the_list_is_whole_and_holds_nothing_twice() {
        let lines = THEIRS.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
        let theirs = parse();
        assert_eq!(theirs.len(), lines.count());
        let mut names: Vec<_> = theirs.iter().map(|theirs| (theirs.class, theirs.name)).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), theirs.len());
    }
}
