//! `etendue diff` and `etendue convert`.

use std::fs;
use std::io::Write;
use std::process::Stdio;

use etendue::image::{
    BitDepth, EncodeOptions, FileFormat, Picture, Samples, decode, decode_picture, encode,
};

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
fn diff_prints_json_and_fails_above_a_limit() {
    let workplace = Workplace::new();
    write_halves(&workplace, "a.exr", [1.0, 2.0]);
    write_halves(&workplace, "b.exr", [1.0, 1.0]);
    let outcome = workplace.succeed(&["diff", "a.exr", "b.exr", "--json"]);
    let object: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(object["mse"], 0.5);
    assert_eq!(object["mean_difference"][2], 0.5);
    assert_eq!(object["non_finite_pixels"], 0);
    let one = workplace.succeed(&["diff", "a.exr", "b.exr", "--json", "--metric", "mse"]);
    assert_eq!(one.stdout, "{\"mse\":0.5}\n");
    for (limit, code) in [("0.5", 0), ("0.499", 1), ("0", 1)] {
        let metric = ["--metric", "mse", "--fail-above", limit];
        let outcome = workplace.run(&[&["diff", "a.exr", "b.exr"], &metric[..]].concat());
        assert_eq!(outcome.code, Some(code), "{limit}: {}", outcome.stderr);
        assert_eq!(outcome.stdout, "0.5\n");
    }
    // Without a metric, the limit is that of relmse.
    assert_eq!(workplace.run(&["diff", "a.exr", "b.exr", "--fail-above", "0.496"]).code, Some(0));
    write_halves(&workplace, "nan.exr", [1.0, f32::NAN]);
    let broken = workplace.run(&["diff", "nan.exr", "b.exr", "--fail-above", "1e9"]);
    assert_eq!(broken.code, Some(1), "{}", broken.stderr);
    workplace.fail(&["diff", "a.exr", "b.exr", "--fail-above", "nan"]);
}

/// A picture with a layer `albedo` and a channel `depth.T`.
fn write_layers(workplace: &Workplace, name: &str, albedo: f32) {
    let mut picture = Picture::new(4, 2);
    for channel in ["R", "G", "B"] {
        picture.push(channel, vec![0.25; 8]);
        picture.push(format!("albedo.{channel}"), vec![albedo; 8]);
    }
    picture.push("depth.T", vec![3.0; 8]);
    let bytes = encode(&picture, FileFormat::Exr, &EncodeOptions::default()).unwrap();
    fs::write(workplace.path(name), bytes).unwrap();
}

#[test]
fn layers_are_converted_and_compared() {
    let workplace = Workplace::new();
    write_layers(&workplace, "a.exr", 0.5);
    write_layers(&workplace, "b.exr", 1.0);
    let values = |layer: &str| {
        workplace.succeed(&["convert", "a.exr", "layer.pfm", "--layer", layer]);
        let picture = decode_picture(&workplace.read("layer.pfm"), "").unwrap();
        (picture.channels.len(), picture.channels[0].data[0])
    };
    assert_eq!(values("albedo"), (3, 0.5));
    assert_eq!(values("albedo.G"), (1, 0.5));
    assert_eq!(values("depth"), (1, 3.0));
    let missing = workplace.fail(&["convert", "a.exr", "c.pfm", "--layer", "albdo"]);
    assert!(missing.stderr.contains("the layers are albedo, depth"), "{}", missing.stderr);
    let difference = |layer: &[&str]| {
        let arguments = [&["diff", "a.exr", "b.exr", "--metric", "mse"], layer].concat();
        workplace.succeed(&arguments).stdout
    };
    assert_eq!(difference(&[]), "0\n");
    assert_eq!(difference(&["--layer", "albedo"]), "0.25\n");
    workplace.fail(&["diff", "a.exr", "b.exr", "--layer", "normal"]);
}

#[test]
fn sixteen_bits_are_kept_and_can_be_asked_for() {
    let workplace = Workplace::new();
    write_halves(&workplace, "a.exr", [0.25, 0.3]);
    let depth_of = |name: &str| match decode(&workplace.read(name), name).unwrap().samples {
        Samples::U16(_) => BitDepth::Sixteen,
        _ => BitDepth::Eight,
    };
    workplace.succeed(&["convert", "a.exr", "plain.png"]);
    assert_eq!(depth_of("plain.png"), BitDepth::Eight);
    for name in ["deep.png", "deep.tiff"] {
        workplace.succeed(&["convert", "a.exr", name, "--depth", "16"]);
        assert_eq!(depth_of(name), BitDepth::Sixteen);
    }
    workplace.succeed(&["convert", "deep.png", "copy.png"]);
    assert_eq!(depth_of("copy.png"), BitDepth::Sixteen);
    assert_eq!(workplace.read("copy.png"), workplace.read("deep.png"));
    workplace.succeed(&["convert", "deep.png", "narrow.png", "--depth", "8"]);
    assert_eq!(depth_of("narrow.png"), BitDepth::Eight);
    workplace.fail(&["convert", "a.exr", "b.jpg", "--depth", "16"]);
}

#[test]
fn numpy_files_come_through_unchanged() {
    let workplace = Workplace::new();
    write_layers(&workplace, "a.exr", 0.5);
    workplace.succeed(&["convert", "a.exr", "a.npy"]);
    workplace.succeed(&["convert", "a.exr", "a.npz"]);
    assert!(workplace.read("a.npy").starts_with(b"\x93NUMPY"));
    for name in ["a.npy", "a.npz"] {
        let outcome = workplace.succeed(&["diff", name, "a.exr", "--metric", "mse"]);
        assert_eq!(outcome.stdout, "0\n", "{name}");
    }
    let layer = ["diff", "a.npz", "a.exr", "--metric", "mse", "--layer", "albedo"];
    assert_eq!(workplace.succeed(&layer).stdout, "0\n");
    fs::write(workplace.path("bad.npz"), b"PK\x03\x04").unwrap();
    workplace.fail(&["convert", "bad.npz", "b.exr"]);
}

#[test]
fn pictures_go_through_standard_input_and_output() {
    let workplace = Workplace::new();
    write_halves(&workplace, "a.exr", [0.25, 0.5]);
    let mut command = workplace.command(&["convert", "-", "-", "--format", "pfm"]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(&workplace.read("a.exr")).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    let picture = decode_picture(&output.stdout, "").unwrap();
    assert_eq!([picture.channels[0].data[0], picture.channels[0].data[15]], [0.25, 0.5]);
    assert_eq!(workplace.files(), ["a.exr"]);
    let unnamed = workplace.fail(&["convert", "a.exr", "-"]);
    assert!(unnamed.stderr.contains("needs --format: exr, png"), "{}", unnamed.stderr);
    // The format overrides the extension.
    workplace.succeed(&["convert", "a.exr", "b.data", "--format", "png"]);
    assert!(workplace.read("b.data").starts_with(b"\x89PNG"));
}

#[test]
fn values_that_a_format_cannot_hold_are_said() {
    let workplace = Workplace::new();
    write_halves(&workplace, "a.exr", [f32::INFINITY, -1.0]);
    let outcome = workplace.succeed(&["convert", "a.exr", "a.hdr"]);
    assert!(outcome.stderr.contains("a.hdr: 192 values are too large and become 1.6947e38"));
    assert!(outcome.stderr.contains("a.hdr: 192 values are negative and become 0"));
    let read = decode_picture(&workplace.read("a.hdr"), "").unwrap();
    assert!(read.channels[0].data[0] > 1.69e38);
    assert_eq!(workplace.succeed(&["convert", "a.exr", "b.exr"]).stderr, "");
}
