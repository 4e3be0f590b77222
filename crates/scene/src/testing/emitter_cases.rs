//! The cases for the tests of all emitters. Each emitter plugin defines them in its own file.

use crate::emitter::{self, emitter_list};
use crate::{BuildOptions, Scene, build_scene};
use etendue_document::{Diagnostics, MemoryResources};
use etendue_image::{Channel, EncodeOptions, FileFormat, Picture, encode};
use etendue_mitsuba::{LoadOptions, read_text};

/// The cases of a plugin. Each is a `<shape>` or an `<emitter>` element, the only light of its
/// scene.
pub(crate) struct Cases {
    /// Lights that rays can hit: samples against the densities of traced rays. Empty for delta
    /// lights.
    pub(crate) hittable: &'static [&'static str],
    /// Lights that illuminate the disk of radius 0.6 around (0, 0, −1): rays from the light against
    /// direction samples. Empty if no point can sample the light.
    pub(crate) leaving: &'static [&'static str],
    /// Extreme lights, whose formulas lose precision: nothing may become infinite, negative or NaN.
    pub(crate) extreme: &'static [&'static str],
}

/// Generates `PLUGINS` from the list of emitters.
macro_rules! cases {
    (
        free { $($module:ident => $name:ident($type:ty);)* }
        shapes { $($nested_module:ident => $nested:ident($nested_type:ty);)* }
    ) => {
        /// The name and the cases of every plugin.
        pub(crate) const PLUGINS: &[(&str, &Cases)] = &[
            $((stringify!($module), &emitter::$module::CASES),)*
            $((stringify!($nested_module), &emitter::$nested_module::CASES),)*
        ];
    };
}

emitter_list!(cases);

/// All lights that rays can hit.
pub(crate) fn hittable() -> impl Iterator<Item = &'static str> {
    PLUGINS.iter().flat_map(|(_, cases)| cases.hittable.iter().copied())
}

/// All lights that illuminate the disk of [`Cases::leaving`].
pub(crate) fn leaving() -> impl Iterator<Item = &'static str> {
    PLUGINS.iter().flat_map(|(_, cases)| cases.leaving.iter().copied())
}

/// All lights at the limits of their formulas.
pub(crate) fn extreme() -> impl Iterator<Item = &'static str> {
    PLUGINS.iter().flat_map(|(_, cases)| cases.extreme.iter().copied())
}

/// A scene of the given elements, which may refer to the files of this module.
pub(crate) fn scene(elements: &str) -> Scene {
    let diagnostics = Diagnostics::new();
    let resources = MemoryResources::default()
        .with("sky.exr", sky())
        .with("slide.exr", slide())
        .with("roof.obj", ROOF)
        .with("field.obj", field());
    let text = format!("<scene version=\"3.0.0\">{elements}</scene>");
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics);
    let document = document.unwrap_or_else(|_| panic!("{:?}", diagnostics.sorted()));
    build_scene(&document, &resources, &diagnostics, &BuildOptions::default())
        .unwrap_or_else(|| panic!("{:?}", diagnostics.sorted()))
}

/// An image with a bright spot on a varying background.
fn sky() -> Vec<u8> {
    let (width, height) = (16, 8);
    let value = |index: usize| {
        let (x, y) = (index % width, index / width);
        if (x, y) == (5, 2) { 40.0 } else { 0.2 + 0.1 * (x + y) as f32 }
    };
    let data: Vec<f32> = (0..width * height).map(value).collect();
    let channels =
        ["R", "G", "B"].map(|name| Channel { name: name.to_owned(), data: data.clone() });
    let picture =
        Picture { channels: channels.to_vec(), ..Picture::new(width as u32, height as u32) };
    encode(&picture, FileFormat::Exr, &EncodeOptions::default())
        .expect("the picture can be written")
}

/// Four by two texels, all different.
fn slide() -> Vec<u8> {
    let channels = [
        [1.0, 0.0, 0.0, 1.0, 0.5, 0.0, 1.0, 0.2],
        [0.0, 1.0, 0.0, 1.0, 0.5, 1.0, 0.0, 0.4],
        [0.0, 0.0, 1.0, 0.0, 0.5, 1.0, 1.0, 0.6],
    ];
    let mut picture = Picture::new(4, 2);
    for (name, data) in ["R", "G", "B"].into_iter().zip(channels) {
        picture.push(name, data.to_vec());
    }
    encode(&picture, FileFormat::Exr, &EncodeOptions::default())
        .expect("the picture can be written")
}

/// Three triangles, the last one degenerate, and a normal for each corner.
const ROOF: &str = "v -1 0 0\nv 1 0 -0.5\nv 0.2 2 1\nv -3 1 2\nv 0 0 -0.25\n\
    vn 0 0 1\nvn 0.3 -0.2 1\nvn -1 0 0.5\nvn 0 0 -1\n\
    f 1//1 2//2 3//3\nf 1//1 3//3 4//4\nf 1//1 2//2 5//1\n";

/// More triangles than one random number can select: a bumpy terrain.
fn field() -> String {
    const SIDE: usize = 50;
    let height = |x: usize, y: usize| (x * 7 + y * 13) % 11;
    let mut text = String::new();
    for (x, y) in (0..=SIDE).flat_map(|x| (0..=SIDE).map(move |y| (x, y))) {
        text +=
            &format!("v {} {} 0.0{}\n", x as f32 * 0.1 - 2.5, y as f32 * 0.1 - 2.5, height(x, y));
    }
    for (x, y) in (0..SIDE).flat_map(|x| (0..SIDE).map(move |y| (x, y))) {
        let a = x * (SIDE + 1) + y + 1;
        let (b, c, d) = (a + SIDE + 1, a + SIDE + 2, a + 1);
        text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    text
}
