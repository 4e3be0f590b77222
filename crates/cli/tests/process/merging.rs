//! `etendue merge`: parts of a picture, and pictures made from them.

use etendue::image::decode_exr_layers;

use crate::run::{Workplace, small_scene};

/// Renders a range of the small scene's samples to a part; returns its name.
fn part(workplace: &Workplace, samples: &str, more: &[&str]) -> String {
    let name = format!("{samples}.part");
    let scene = small_scene();
    let arguments = ["render", &scene, "-q", "--spp", "20", "--samples", samples, "-o", &name];
    workplace.succeed(&[&arguments, more].concat());
    name
}

#[test]
fn parts_in_any_order_merge_to_the_picture_of_a_single_render() {
    let workplace = Workplace::new();
    let variance = ["--variance"];
    let parts = [
        part(&workplace, "7..8", &["-t", "1", "--variance"]),
        part(&workplace, "0..7", &["-t", "3", "--variance"]),
        part(&workplace, "8..20", &variance),
    ];
    let scene = small_scene();
    workplace.succeed(&["render", &scene, "-q", "--spp", "20", "--variance", "-o", "whole.exr"]);
    let whole = decode_exr_layers(&workplace.read("whole.exr")).unwrap();
    for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
        let names = order.map(|index| parts[index].as_str());
        workplace.succeed(&[&["merge", "-q", "-o", "merged.exr"], &names[..]].concat());
        let merged = decode_exr_layers(&workplace.read("merged.exr")).unwrap();
        assert_eq!(merged.channels, whole.channels);
        assert_eq!(merged.metadata("samplesPerPixel"), whole.metadata("samplesPerPixel"));
        assert_eq!(merged.metadata("sceneHash"), whole.metadata("sceneHash"));
        assert_eq!(merged.metadata("worldToNDC"), whole.metadata("worldToNDC"));
    }
}

/// Particles contribute to any pixel, so their sums belong to the whole film.
#[test]
fn parts_of_a_particle_render_merge_to_its_picture() {
    let workplace = Workplace::new();
    let particles = ["--integrator", "ptracer"];
    let parts = ["0..3", "9..20", "3..9"].map(|samples| part(&workplace, samples, &particles));
    let names: Vec<&str> = parts.iter().map(String::as_str).collect();
    workplace.succeed(&[&["merge", "-q", "-o", "merged.pfm"], &names[..]].concat());
    let scene = small_scene();
    let whole = ["render", &scene, "-q", "--spp", "20", "-o", "whole.pfm"];
    workplace.succeed(&[&whole[..], &particles].concat());
    assert_eq!(workplace.read("merged.pfm"), workplace.read("whole.pfm"));
    assert!(
        workplace.read("whole.pfm")[40..].iter().any(|byte| *byte != 0),
        "the picture must not be black"
    );
}

#[test]
fn parts_merge_to_larger_parts() {
    let workplace = Workplace::new();
    let [a, b, c] = ["0..5", "5..11", "11..20"].map(|samples| part(&workplace, samples, &[]));
    workplace.succeed(&["merge", "-q", &b, &c, "-o", "bc.part"]);
    workplace.succeed(&["merge", "-q", "bc.part", &a, "-o", "merged.pfm"]);
    let scene = small_scene();
    workplace.succeed(&["render", &scene, "-q", "--spp", "20", "-o", "whole.pfm"]);
    assert_eq!(workplace.read("merged.pfm"), workplace.read("whole.pfm"));
    let outcome = workplace.fail(&["merge", "-q", &a, &c, "-o", "ac.part"]);
    assert!(outcome.stderr.contains("5..11"), "{}", outcome.stderr);
}

#[test]
fn parts_that_do_not_fit_together_are_rejected() {
    let workplace = Workplace::new();
    let [a, b, across, end] =
        ["0..5", "5..11", "4..8", "11..20"].map(|samples| part(&workplace, samples, &[]));
    let other = part(&workplace, "12..20", &["--seed", "3"]);
    let cases: [(&[&str], &str); 6] = [
        (&[&a, &b], "no part holds the samples 11..20"),
        (&[&a, &end], "no part holds the samples 5..11"),
        (&[&a, &b, &across, &end], "both hold the samples 4..5"),
        (&[&a, &a], "both hold the samples 0..5"),
        (&[&a, &b, &other], "seed: 0; 3"),
        (&[&a, "nowhere.part"], "nowhere.part"),
    ];
    for (parts, message) in cases {
        let outcome = workplace.fail(&[&["merge", "-o", "a.pfm"], parts].concat());
        assert!(outcome.stderr.contains(message), "{parts:?}: {}", outcome.stderr);
    }
    let arguments = ["merge", "--allow-missing", &end, &a, "-o", "a.pfm"];
    let outcome = workplace.succeed(&arguments);
    assert!(outcome.stderr.contains("5..11"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("14 samples per pixel"), "{}", outcome.stderr);
}

#[test]
fn a_range_of_samples_needs_a_part_and_lies_among_those_planned() {
    let workplace = Workplace::new();
    let scene = small_scene();
    let cases: [(&[&str], &str); 5] = [
        (&["--samples", "1/5", "-o", "a.part"], "0..0 are not among the 4"),
        (&["--samples", "0..2", "-o", "a.exr"], ".part"),
        (&["--samples", "2..9", "-o", "a.part"], "2..9 are not among the 4"),
        (&["--samples", "3..3", "-o", "a.part"], "A..B"),
        (&["--samples", "3", "-o", "a.part"], "A..B"),
    ];
    for (more, message) in cases {
        let outcome = workplace.fail(&[&["render", &scene], more].concat());
        assert!(outcome.stderr.contains(message), "{more:?}: {}", outcome.stderr);
    }
    workplace.succeed(&["render", &scene, "-q", "--samples", "1..3"]);
    workplace.succeed(&["render", &scene, "-q", "--samples", "2/3"]);
    assert_eq!(workplace.files(), ["small.1-3.part", "small.2-of-3.part"]);
}
