//! `etendue diff` and `etendue convert`.

use std::fs;

use etendue::image::{EncodeOptions, FileFormat, Picture, decode_picture, encode};

use crate::run::{Workplace, small_scene};

/// Writes a grey picture whose left half has one value and whose right half another.
fn write_halves(workplace: &Workplace, name: &str, [left, right]: [f32; 2]) {
    let mut picture = Picture::new(16, 8);
    for channel in ["R", "G", "B"] {
        let data = (0..128).map(|index| if index % 16 < 8 { left } else { right }).collect();
        picture.push(channel, data);
    }
    let bytes = encode(&picture, FileFormat::Exr, &EncodeOptions::default()).unwrap();
    fs::write(workplace.path(name), bytes).unwrap();
}

#[test]
fn diff_prints_every_metric() {
    let workplace = Workplace::new();
    write_halves(&workplace, "a.exr", [1.0, 2.0]);
    write_halves(&workplace, "b.exr", [1.0, 1.0]);
    let outcome = workplace.succeed(&["diff", "a.exr", "b.exr"]);
    assert!(outcome.stdout.contains("MSE     5.000000e-1\n"), "{}", outcome.stdout);
    assert!(outcome.stdout.contains("+0.500000 +0.500000 +0.500000\n"), "{}", outcome.stdout);
    assert!(outcome.stdout.contains("+50.000 %"), "{}", outcome.stdout);
    let same = workplace.succeed(&["diff", "a.exr", "a.exr"]);
    for row in ["MSE     0.0", "relMSE  0.0", "FLIP    0.000000"] {
        assert!(same.stdout.contains(row), "{}", same.stdout);
    }
}

#[test]
fn diff_prints_one_number_for_scripts() {
    let workplace = Workplace::new();
    write_halves(&workplace, "a.exr", [1.0, 2.0]);
    write_halves(&workplace, "b.exr", [1.0, 1.0]);
    let number = |metric: &str| {
        let outcome = workplace.succeed(&["diff", "a.exr", "b.exr", "--metric", metric]);
        outcome.stdout.trim().parse::<f64>().unwrap()
    };
    assert_eq!(number("mse"), 0.5);
    assert!((number("relmse") - 0.5 / 1.01).abs() < 1e-6);
    // A display clips values above one.
    assert_eq!(number("flip"), 0.0);
}

#[test]
fn diff_counts_blocks_that_differ_by_more_than_noise() {
    let workplace = Workplace::new();
    write_halves(&workplace, "a.exr", [1.0, 1.1]);
    write_halves(&workplace, "b.exr", [1.0, 1.0]);
    // For a block of 64 pixels, the difference of 0.1 is 5.7 or 2.8 standard errors.
    for (variance, share) in [(0.01, "50.000 %"), (0.04, "0.000 %")] {
        write_halves(&workplace, "var.exr", [variance, variance]);
        let scaled = "var.exr@1";
        let arguments = ["diff", "a.exr", "b.exr", "--variance", "var.exr", "--variance", scaled];
        let outcome = workplace.succeed(&arguments);
        let line = format!("blocks  {share} off by more than 4 standard errors (");
        assert!(outcome.stdout.contains(&line), "{}", outcome.stdout);
    }
    // The file holds the variance of single samples; the mean has 25 of them.
    let sample = ["diff", "a.exr", "b.exr", "--variance", "var.exr@25", "--variance", "var.exr@25"];
    let outcome = workplace.succeed(&sample);
    assert!(outcome.stdout.contains("and 2 % (1 of 2)"), "{}", outcome.stdout);
    workplace.fail(&["diff", "a.exr", "b.exr", "--variance", "var.exr"]);
}

#[test]
fn renders_with_different_seeds_agree_within_their_variance() {
    let workplace = Workplace::new();
    for (name, seed) in [("a.exr", "1"), ("b.exr", "2")] {
        let scene = small_scene();
        let arguments = ["render", &scene, "-q", "--spp", "64", "--variance", "--seed", seed];
        workplace.succeed(&[&arguments[..], &["-o", name]].concat());
    }
    let outcome = workplace.succeed(&["diff", "a.exr", "b.exr"]);
    assert!(outcome.stdout.contains("blocks  0.000 % off"), "{}", outcome.stdout);
}

#[test]
fn diff_writes_an_error_map() {
    let workplace = Workplace::new();
    write_halves(&workplace, "a.exr", [1.0, 2.0]);
    write_halves(&workplace, "b.exr", [1.0, 1.0]);
    for metric in ["mse", "relmse", "flip"] {
        workplace.succeed(&["diff", "a.exr", "b.exr", "--metric", metric, "-o", "map.png"]);
        let map = decode_picture(&workplace.read("map.png"), "map.png").unwrap();
        assert_eq!((map.width, map.height), (16, 8));
    }
}

#[test]
fn pictures_that_cannot_be_compared_are_rejected() {
    let workplace = Workplace::new();
    write_halves(&workplace, "a.exr", [1.0, 2.0]);
    workplace.succeed(&["render", &small_scene(), "-q", "-o", "b.exr"]);
    let sizes = workplace.fail(&["diff", "a.exr", "b.exr"]);
    assert!(sizes.stderr.contains("16x8") && sizes.stderr.contains("40x24"), "{}", sizes.stderr);
    fs::write(workplace.path("text.exr"), "hello").unwrap();
    workplace.fail(&["diff", "a.exr", "text.exr"]);
    workplace.fail(&["diff", "a.exr", "nowhere.exr"]);
    workplace.fail(&["diff", "a.exr", "a.exr", "-o", "map.txt"]);
}

#[test]
fn convert_applies_exposure_and_tone_mapping() {
    let workplace = Workplace::new();
    write_halves(&workplace, "a.exr", [0.25, 4.0]);
    let convert = |name: &str, arguments: &[&str]| {
        workplace.succeed(&[&["convert", "a.exr", name], arguments].concat());
        let picture = decode_picture(&workplace.read(name), name).unwrap();
        [picture.channels[0].data[0], picture.channels[0].data[15]]
    };
    assert_eq!(convert("b.pfm", &[]), [0.25, 4.0]);
    assert_eq!(convert("b.exr", &["--exposure", "-2"]), [0.0625, 1.0]);
    let [dark, bright] = convert("b.png", &["--exposure", "1"]);
    assert!((dark - 0.5).abs() < 0.01, "{dark}");
    assert_eq!(bright, 1.0);
    for curve in ["aces", "agx", "filmic"] {
        let [dark, bright] = convert("c.png", &["--tonemap", curve]);
        assert!(dark > 0.0 && dark < bright && bright < 1.0, "{curve}: {dark} {bright}");
    }
    workplace.fail(&["convert", "a.exr", "b.xyz"]);
    workplace.fail(&["convert", "nowhere.exr", "d.png"]);
    workplace.fail(&["convert", "a.exr", "d.png", "--tonemap", "magic"]);
}

#[test]
fn variances_beyond_single_precision_are_clamped_and_said() {
    let workplace = Workplace::new();
    let scene = "<scene version=\"3.0.0\"><sensor type=\"perspective\"/><shape type=\"sphere\">\
                 <transform name=\"to_world\"><translate z=\"4\"/></transform></shape>\
                 <emitter type=\"constant\"><rgb name=\"radiance\" value=\"1e30\"/></emitter></scene>";
    std::fs::write(workplace.path("a.xml"), scene).unwrap();
    let size = ["--size", "16x16", "--spp", "8", "--variance"];
    let outcome =
        workplace.succeed(&[&["render", "a.xml", "-q", "-o", "a.exr"], &size[..]].concat());
    assert!(outcome.stderr.contains("beyond single precision"), "{}", outcome.stderr);
    let picture = etendue::image::decode_exr_layers(&workplace.read("a.exr")).unwrap();
    assert!(picture.channels.iter().flat_map(|layer| &layer.data).all(|value| value.is_finite()));
}
