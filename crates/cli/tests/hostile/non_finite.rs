//! Non-finite and negative samples are counted, reported, left out, and can be replayed.

use std::fs;

use etendue::image::{Picture, decode_picture};

use crate::case::Parts;
use crate::run::{Outcome, Workplace};

/// Renders a light that fills the film and has a texture of 2 by 2 texels. The broken texel covers
/// the lower left quarter.
fn render(broken: f32) -> (Workplace, Outcome) {
    let workplace = Workplace::new();
    let texels = [1.0, 2.0, broken, 4.0].map(f32::to_le_bytes);
    let grey = texels.map(|texel| [texel; 3].concat()).concat();
    let bytes = [&b"PF\n2 2\n-1.0\n"[..], &grey].concat();
    fs::write(workplace.path("light.pfm"), bytes).unwrap();
    let parts = Parts {
        sensor: r#"<float name="fov" value="50"/><transform name="to_world"><lookat origin="0, 0, 2" target="0, 0, 0" up="0, 1, 0"/></transform>"#,
        film: r#"<film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/><rfilter type="box"/></film>"#,
        content: r#"<shape type="rectangle"><emitter type="area"><texture type="bitmap" name="radiance"><string name="filename" value="light.pfm"/><string name="filter_type" value="nearest"/><boolean name="raw" value="true"/></texture></emitter></shape>"#,
        ..Parts::default()
    };
    fs::write(workplace.path("a scene.xml"), parts.scene()).unwrap();
    let outcome = workplace.succeed(&["render", "a scene.xml", "--spp", "4", "-o", "a.pfm"]);
    (workplace, outcome)
}

fn picture(workplace: &Workplace) -> Picture {
    decode_picture(&workplace.read("a.pfm"), "a.pfm").unwrap()
}

#[test]
fn invalid_samples_are_counted_and_left_out() {
    let whole = picture(&render(3.0).0);
    for (broken, count) in [
        (f32::NAN, "64 not finite, 0 negative"),
        (f32::INFINITY, "64 not finite, 0 negative"),
        (-3.0, "0 not finite, 64 negative"),
    ] {
        let (workplace, outcome) = render(broken);
        // A quarter of 64 pixels with 4 samples each.
        assert!(
            outcome.stderr.contains("64 samples left out of the picture"),
            "{}",
            outcome.stderr
        );
        assert!(outcome.stderr.contains(count), "{}", outcome.stderr);
        let picture = picture(&workplace);
        for (index, (found, expected)) in
            picture.channels[0].data.iter().zip(&whole.channels[0].data).enumerate()
        {
            let is_broken = index % 8 < 4 && index / 8 >= 4;
            assert_eq!(*found, if is_broken { 0.0 } else { *expected }, "pixel {index}");
        }
    }
}

#[test]
fn loading_a_texture_with_non_finite_values_gives_a_warning() {
    let (_, outcome) = render(f32::NAN);
    let warning = outcome.stderr.split("warning: ").nth(1).unwrap();
    assert!(warning.contains("light.pfm holds values that are not finite"), "{warning}");
    assert!(warning.contains("a scene.xml:7:"), "{warning}");
}

#[cfg(unix)]
#[test]
fn the_suggested_command_replays_the_sample() {
    let cases = [
        (f32::NAN, "not finite", "radiance  NaN NaN NaN\n"),
        (-3.0, "negative", "radiance  -3 -3 -3\n"),
    ];
    for (broken, kind, radiance) in cases {
        let (workplace, outcome) = render(broken);
        let line = outcome.stderr.lines().find_map(|line| line.trim().strip_prefix(kind));
        let command = line.unwrap().trim_start_matches(": ");
        assert!(command.contains("--replay 0,4,0"), "the first pixel must come first: {command}");
        let mut shell = std::process::Command::new("sh");
        let output = shell.args(["-c", command]).current_dir(workplace.path("")).output().unwrap();
        let replay = Outcome::from(output);
        assert_eq!(replay.code, Some(0), "{command}: {}", replay.stderr);
        assert!(replay.stdout.contains(radiance), "{}", replay.stdout);
    }
}

#[test]
fn light_beyond_half_precision_is_not_clipped() {
    let workplace = Workplace::new();
    let scene = Parts::default().scene();
    let bright =
        r#"<emitter type="constant"><rgb name="radiance" value="1e6, 1e6, 1e6"/></emitter>"#;
    let scene = scene.replace(r#"<emitter type="constant"/>"#, bright);
    fs::write(workplace.path("scene.xml"), scene).unwrap();
    workplace.succeed(&["render", "scene.xml", "-o", "a.exr"]);
    let picture = decode_picture(&workplace.read("a.exr"), "a.exr").unwrap();
    assert!(picture.channels.iter().all(|channel| channel.data.iter().all(|&value| value == 1e6)));
}
