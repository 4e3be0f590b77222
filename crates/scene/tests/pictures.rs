//! Image files that several textures share.

use etendue_document::{Diagnostics, MemoryResources, Span};
use etendue_math::Ray;
use etendue_mitsuba::{LoadOptions, read_text};
use etendue_scene::{BuildOptions, Scene, build_scene};
use glam::Vec3;

/// Two texels side by side in a PFM file: the colours (0.25, 0.5, 0.75) and black.
fn two_texels() -> Vec<u8> {
    let numbers = [0.25_f32, 0.5, 0.75, 0.0, 0.0, 0.0];
    let header = b"PF\n2 1\n-1.0\n".iter().copied();
    header.chain(numbers.into_iter().flat_map(f32::to_le_bytes)).collect()
}

/// A unit square in the plane z = 0 around the given x, with the texture of a file.
fn square(x: i32, file: &str, texture: &str) -> String {
    format!(
        "<shape type='rectangle'>
           <transform name='to_world'><scale value='0.5'/><translate x='{x}'/></transform>
           <bsdf type='diffuse'><texture name='reflectance' type='bitmap'>
             <string name='filename' value='{file}'/>
             <string name='filter_type' value='nearest'/>{texture}
           </texture></bsdf>
         </shape>"
    )
}

/// Builds a scene, or returns its diagnostics with their places. A scene that is built must have
/// none.
fn build(shapes: &[String]) -> Result<Scene, Vec<(String, Option<Span>)>> {
    let resources =
        MemoryResources::default().with("a.pfm", two_texels()).with("broken.png", b"no picture");
    let diagnostics = Diagnostics::new();
    let shapes = shapes.concat();
    let text = format!("<scene version='3.0.0'><sensor type='perspective'/>{shapes}</scene>");
    let document = read_text(&text, &resources, &LoadOptions::default(), &diagnostics).ok();
    let options = BuildOptions::default();
    let scene =
        document.and_then(|document| build_scene(&document, &resources, &diagnostics, &options));
    let found = diagnostics.sorted().into_iter().map(|found| (found.message, found.span));
    let found: Vec<_> = found.collect();
    if found.is_empty() { Ok(scene.expect("a scene")) } else { Err(found) }
}

/// The albedo at the hit of a ray straight down at (x, 0).
fn color(scene: &Scene, x: f32) -> [f32; 3] {
    let surface = scene.intersect(&Ray::new(Vec3::new(x, 0.0, 5.0), -Vec3::Z)).expect("a hit");
    scene.prepare_bsdf(&surface).albedo(surface.wi).rgb()
}

#[test]
fn textures_share_the_texels_that_they_take_of_the_same_file() {
    let mirrored = "<transform name='to_uv'><scale x='-1'/></transform>";
    let one_channel = "<string name='channel' value='g'/>";
    let scene = build(&[
        square(0, "a.pfm", ""),
        square(2, "./a.pfm", mirrored),
        square(4, "a.pfm", one_channel),
        square(6, "a.pfm", one_channel),
    ])
    .expect("a scene");
    let (black, bright) = ([0.0; 3], [0.25, 0.5, 0.75]);
    assert_eq!([-0.2, 0.2].map(|x| color(&scene, x)), [bright, black]);
    assert_eq!([1.8, 2.2].map(|x| color(&scene, x)), [black, bright]);
    assert_eq!([3.8, 5.8].map(|x| color(&scene, x)), [[0.5; 3]; 2]);
    let statistics = scene.statistics();
    assert_eq!(statistics.textures, 4);
    // Two texels of three numbers, and two of one.
    assert_eq!(statistics.texture_bytes, 4 * (2 * 3 + 2));
}

#[test]
fn every_texture_says_that_its_file_is_broken_or_missing() {
    for file in ["broken.png", "missing.png"] {
        let found = build(&[square(0, file, ""), square(2, file, "")]).expect_err("no scene");
        let [(first, first_place), (second, second_place)] = &found[..] else {
            panic!("{found:?}");
        };
        assert!(first.contains(file) && first == second, "{found:?}");
        assert_ne!(first_place, second_place, "{found:?}");
    }
}

#[test]
fn what_is_odd_about_a_texture_is_reported_once() {
    let odd = "<boolean name='raw' value='true'/><boolean name='raw' value='true'/>\
               <float name='blur' value='1'/>";
    let found = build(&[square(0, "a.pfm", odd), square(2, "a.pfm", "")]).expect_err("warnings");
    let messages: Vec<&str> = found.iter().map(|(message, _)| message.as_str()).collect();
    let twice = "`raw` is given twice; the last one counts";
    assert_eq!(messages, [twice, "`bitmap` has no parameter `blur`"]);
}

#[test]
fn a_channel_that_is_not_there_is_an_error_of_the_texture_that_asks_for_it() {
    let alpha = "<string name='channel' value='a'/>";
    let found = build(&[square(0, "a.pfm", ""), square(2, "a.pfm", alpha)]).expect_err("no scene");
    let messages: Vec<&str> = found.iter().map(|(message, _)| message.as_str()).collect();
    assert_eq!(messages, ["a.pfm has no such channel"]);
}
