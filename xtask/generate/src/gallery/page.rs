//! The gallery's page.

use std::fmt::Write as _;

use super::table::{EmitterSampling, Entry, SECTIONS, Section};

/// The text of `gallery/README.md`.
pub(super) fn page() -> String {
    let mut text = String::from(
        "# Gallery\n\n\
         <!-- Written by `cargo xtask gallery`. -->\n\n\
         Every picture was rendered by Etendue from a scene of this repository; \
         `cargo xtask gallery` renders them all again.\n",
    );
    for section in SECTIONS {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n## {}\n\n{}\n\n", section.heading, section.text);
        text.push_str(&pictures(section));
        let _ = writeln!(text, "\n[Scene](../scenes/{}/scene.xml)\n", section.scene);
        text.push_str("```sh\n");
        for entry in section.pictures {
            let _ = writeln!(text, "{}", command(section, entry));
        }
        text.push_str("```\n");
    }
    text
}

/// A single picture, or a table with one column for each.
fn pictures(section: &Section) -> String {
    let image = |entry: &Entry| {
        let alternative = if entry.caption.is_empty() { section.heading } else { entry.caption };
        format!("![{alternative}]({}.png)", entry.name)
    };
    if let [only] = section.pictures {
        return format!("{}\n", image(only));
    }
    let row = |cell: &dyn Fn(&Entry) -> String| {
        let cells: Vec<String> = section.pictures.iter().map(cell).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    row(&image) + &row(&|_| "---".to_owned()) + &row(&|entry| entry.caption.to_owned())
}

/// The command that renders a picture.
fn command(section: &Section, entry: &Entry) -> String {
    let mut text = format!("etendue render scenes/{}/scene.xml", section.scene);
    let _ = write!(text, " --spp {}", entry.samples_per_pixel);
    for (name, value) in entry.defines {
        let _ = write!(text, " -D {name}={value}");
    }
    if entry.emitter_sampling == EmitterSampling::Off {
        text.push_str(" --no-emitter-sampling");
    }
    let _ = write!(text, " -o {}.png", entry.name);
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repository::root;

    #[test]
    fn the_committed_page_is_current_and_has_its_pictures() {
        let committed = std::fs::read_to_string(root().join("gallery/README.md")).unwrap();
        assert_eq!(committed, page(), "run `cargo xtask gallery`");
        for entry in SECTIONS.iter().flat_map(|section| section.pictures) {
            assert!(root().join(format!("gallery/{}.png", entry.name)).is_file(), "{}", entry.name);
        }
    }
}
