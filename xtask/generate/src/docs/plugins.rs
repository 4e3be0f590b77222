//! The plugin reference, from the manual pages in the plugins' code.

use std::fmt::Write as _;

use etendue::document::Class;
use etendue::scene::Manual;
use etendue::{integrators, scene, spectrum};

/// The path of the page.
pub(super) const PATH: &str = "docs/plugins.md";

type Page = (Class, &'static str, &'static Manual);

/// The text of the page.
pub(super) fn page() -> String {
    let mut pages = scene::registry::plugins();
    pages.extend(integrators::plugins());
    let mut text = String::from(
        "# Plugin reference\n\n\
         <!-- Written by `cargo xtask docs` from the manual pages in the code. -->\n\n\
         Every plugin with all its parameters. A parameter of kind “texture” or “bsdf” is a nested \
         element or a `<ref>`. An empty default means that the parameter is required, or that nothing \
         happens without it.\n\n",
    );
    for class in classes(&pages) {
        let names = pages.iter().filter(|page| page.0 == class);
        let links: Vec<String> =
            names.map(|(class, name, _)| format!("[{name}](#{})", anchor(*class, name))).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "- **{}**: {}", class.name(), links.join(", "));
    }
    for class in classes(&pages) {
        let _ = write!(text, "\n## {}\n{}", class.name(), nested(class));
        for page in pages.iter().filter(|page| page.0 == class) {
            write_plugin(&mut text, page);
        }
    }
    text + &materials()
}

/// The names that `material`, `int_ior` and `ext_ior` take.
fn materials() -> String {
    let list = |names: &mut dyn Iterator<Item = &'static str>| {
        names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    };
    let metals = list(&mut spectrum::metal_names());
    let dielectrics = list(&mut spectrum::refractive_index_names());
    format!(
        "\n## Names of materials\n\n\
         Upper and lower case are the same.\n\n\
         **Metals** (`material` of `conductor` and `roughconductor`), also by their English names, such as \
         `gold`: {metals}.\n\n\
         **Dielectrics** (`int_ior` and `ext_ior`): {dielectrics}.\n"
    )
}

/// What all plugins of a class may hold in addition to what their pages list.
fn nested(class: Class) -> &'static str {
    match class {
        Class::Shape => {
            "\nEvery shape but `shapegroup` and `instance` also takes, nested or as a `<ref>`:\n\n\
             | name | kind | meaning |\n|---|---|---|\n\
             | | bsdf | Its material; `diffuse` without one. |\n\
             | | emitter | The light that it sends out, such as `area`. |\n\
             | | sensor | A sensor on its surface, such as `irradiancemeter`. |\n\
             | `interior` | medium | What it is filled with: the side that normals point away from. |\n\
             | `exterior` | medium | What is around it. |\n"
        }
        Class::Sensor => {
            "\nEvery sensor also takes the medium that it stands in, nested or as a `<ref>`.\n"
        }
        _ => "",
    }
}

/// The classes that have plugins, each once, in the order of the registry.
fn classes(pages: &[Page]) -> Vec<Class> {
    let mut classes: Vec<Class> = pages.iter().map(|page| page.0).collect();
    classes.dedup();
    classes
}

/// The anchor of a plugin's heading on the page, as GitHub generates it.
fn anchor(class: Class, name: &str) -> String {
    format!("{}-{name}", class.name()).to_lowercase().replace(' ', "-")
}

fn write_plugin(text: &mut String, (class, name, manual): &Page) {
    let _ = write!(text, "\n### {} `{name}`\n\n{}\n", class.name(), manual.summary);
    if !manual.parameters.is_empty() {
        text.push_str("\n| parameter | kind | default | meaning |\n|---|---|---|---|\n");
    }
    for parameter in manual.parameters {
        let default = match parameter.default {
            "" => String::new(),
            default => format!("`{default}`"),
        };
        let cells = [format!("`{}`", parameter.name), parameter.kind.to_owned(), default];
        let cells = cells.map(|cell| escape(&cell));
        let _ = writeln!(text, "| {} | {} |", cells.join(" | "), escape(parameter.meaning));
    }
    let (language, sample) = (manual.sample_language(), manual.sample.trim());
    let _ = write!(text, "\n```{language}\n{sample}\n```\n");
}

/// A bar would end the table cell.
fn escape(text: &str) -> String {
    text.replace('|', "\\|")
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
}
