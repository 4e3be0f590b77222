//! The gallery's page.

use std::fmt::Write as _;

use super::table::{PICTURES, Picture};

const HEAD: &str = "# Gallery

<!-- Written by `cargo xtask gallery`. -->

Etendue rendered every picture from a scene of this repository. `cargo xtask assets` makes the files
of the scenes that are too large to be committed, and `cargo xtask gallery` renders the pictures
again. They have few samples per pixel. Single pixels far brighter than their neighbours are limited, and
what is left of the noise is removed by non-local means, guided by albedo and normals
([denoise.rs](../xtask/generate/src/gallery/denoise.rs)); nothing else was retouched. The commands below
show the scenes without that step. The times are those of a
machine with two cores (Intel Xeon, 2.5 GHz) that were busy with other jobs for most of the time.
";

const TAIL: &str = "
## Smaller scenes

[A Cornell box](../scenes/cornell-box/scene.xml), [glass and metal](../scenes/glass-and-metal/scene.xml),
[plastics](../scenes/plastics/scene.xml), [rough metals](../scenes/rough-metals/scene.xml),
[textures](../scenes/textures/scene.xml), [smoke](../scenes/smoke/scene.xml),
[soft shadows](../scenes/soft-shadows/scene.xml) and
[depth of field](../scenes/depth-of-field/scene.xml) show one thing each, and render in a minute.

## Larger scenes

[A meadow](../scenes/meadow/scene.xml) of more than a million instances and
[a plush bear](../scenes/fur/scene.xml) of 130,000 hairs have no picture here yet, because they take
hours on a small machine.
";

/// The text of `gallery/README.md`.
pub(super) fn page() -> String {
    let mut text = String::from(HEAD);
    for picture in PICTURES {
        text.push_str(&section(picture));
    }
    text + TAIL
}

fn section(picture: &Picture) -> String {
    let Picture { name, heading, text, size: [width, height], .. } = picture;
    let spp = picture.samples_per_pixel;
    let scene = picture.scene();
    let mut section = format!("\n## {heading}\n\n![{heading}]({name}.jpg)\n\n{text}\n\n");
    // Writing to a string cannot fail.
    let _ = write!(
        section,
        "[Scene](../{scene}) · {width} × {height} pixels · {spp} samples per pixel · \
         {} minutes · shown by {}\n\n",
        picture.minutes,
        picture.display(),
    );
    let _ = write!(section, "```sh\netendue render {scene} --spp {spp} -o {name}.exr\n```\n");
    section
}

#[cfg(test)]
mod tests {
    use etendue::image::decode;

    use super::*;
    use crate::repository::root;

    #[test]
    fn the_committed_page_is_current_and_has_its_pictures() {
        let committed = std::fs::read_to_string(root().join("gallery/README.md")).unwrap();
        assert_eq!(committed, page(), "run `cargo xtask gallery`");
        for picture in PICTURES {
            let name = picture.file_name();
            let bytes = std::fs::read(root().join("gallery").join(&name)).unwrap();
            let image = decode(&bytes, &name).unwrap();
            assert_eq!([image.width, image.height], picture.size, "{name}");
        }
    }
}
