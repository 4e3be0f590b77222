//! Look-ups compared with Mitsuba's, and files of every precision.

use super::*;
use crate::testing::node::TestNode;
use etendue_document::{Class, Value};
use etendue_image::{EncodeOptions, FileFormat, Picture, Samples, encode};
use glam::{DMat4, DVec3};

const MITSUBA: &str = include_str!("../mitsuba_texels.txt");

fn numbers(text: &str) -> Vec<f32> {
    text.split_whitespace().map(|number| number.parse().expect("a number")).collect()
}

/// The picture for which Mitsuba's values were recorded.
fn recorded_bitmap() -> Bitmap {
    let line = MITSUBA.lines().find_map(|line| line.strip_prefix("texels ")).expect("texels");
    let samples = Samples::U16(line.split(' ').map(|code| code.parse().expect("a code")).collect());
    Bitmap { width: 5, height: 3, channels: 3, samples, srgb: true, ..Bitmap::default() }
}

#[test]
fn values_and_gradients_are_those_of_mitsuba() {
    let records = MITSUBA.lines().filter(|line| line.contains('|') && !line.starts_with('#'));
    let mut count = 0;
    for line in records {
        let fields: Vec<&str> = line.split('|').map(str::trim).collect();
        let rows = numbers(fields[2]);
        let options = BitmapOptions {
            filter: if fields[0] == "nearest" { FilterMode::Nearest } else { FilterMode::Bilinear },
            wrap: match fields[1] {
                "mirror" => WrapMode::Mirror,
                "clamp" => WrapMode::Clamp,
                _ => WrapMode::Repeat,
            },
            raw: true,
            channel: None,
            to_uv: Affine2::from_cols(
                Vec2::new(rows[0], rows[3]),
                Vec2::new(rows[1], rows[4]),
                Vec2::new(rows[2], rows[5]),
            ),
        };
        let texture = BitmapTexture::new(recorded_bitmap(), &options).expect("a sound picture");
        let uv = Vec2::from_slice(&numbers(fields[3]));
        let color = Spectrum::from_rgb(numbers(fields[4]).try_into().expect("three numbers"));
        let gradient = Vec2::from_slice(&numbers(fields[5]));
        let found = texture.eval(uv);
        assert!((found - color).abs().max_component() < 3e-6, "{line}: {found:?}");
        assert!((texture.eval_scalar(uv) - color.luminance()).abs() < 3e-6, "{line}");
        let found = texture.gradient(uv);
        assert!((found - gradient).length() < 3e-5, "{line}: {found}");
        count += 1;
    }
    assert_eq!(count, 108);
}

#[test]
fn gradients_are_the_slopes_of_the_values() {
    let to_uv = Affine2::from_scale_angle_translation(Vec2::new(2.0, 3.0), 0.5, Vec2::splat(0.1));
    for wrap in [WrapMode::Repeat, WrapMode::Mirror, WrapMode::Clamp] {
        let options = BitmapOptions { wrap, to_uv, ..BitmapOptions::default() };
        let texture = BitmapTexture::new(recorded_bitmap(), &options).expect("a sound picture");
        let mut compared = 0;
        for index in 0..200 {
            let uv = Vec2::new(index as f32 * 0.037 - 3.0, index as f32 * 0.0171 - 1.0);
            let step = 1e-3;
            let slope = |axis: Vec2| {
                let ends = [uv - axis * step, uv + axis * step];
                // The slope changes at texel centres.
                let cell = |uv| (to_uv.transform_point2(uv) * Vec2::new(5.0, 3.0) - 0.5).floor();
                let [left, right] = ends.map(|uv| texture.eval_scalar(uv));
                (cell(ends[0]) == cell(ends[1])).then_some((right - left) / (2.0 * step))
            };
            if let (Some(u), Some(v)) = (slope(Vec2::X), slope(Vec2::Y)) {
                let found = texture.gradient(uv);
                // Values have 24 bits, and the step has ten fewer.
                assert!(
                    (found - Vec2::new(u, v)).length() < 2e-3,
                    "{wrap:?} {uv}: {found}, {u} {v}"
                );
                compared += 1;
            }
        }
        assert!(compared > 150, "{compared}");
    }
}

/// A texture with a single texel.
fn single(samples: Samples, channels: u32, options: &BitmapOptions) -> Option<BitmapTexture> {
    let srgb = matches!(samples, Samples::U8(_) | Samples::U16(_));
    let (width, height) = (1, 1);
    let bitmap = Bitmap { width, height, channels, samples, srgb, ..Bitmap::default() };
    BitmapTexture::new(bitmap, options)
}

#[test]
fn precisions_and_encodings_agree() {
    let centre = Vec2::splat(0.3);
    let (encoded, raw) =
        (BitmapOptions::default(), BitmapOptions { raw: true, ..Default::default() });
    let eight = || Samples::U8(vec![0, 51, 255]);
    let sixteen = || Samples::U16(vec![0, 51 * 257, 65535]);
    let float = || Samples::F32(vec![0.0, 0.2, 1.0]);
    let half = Samples::F16(vec![Default::default(); 3]);
    let value = |samples, options| single(samples, 3, options).map(|t| t.eval(centre).rgb());
    let near = |found: Option<[f32; 3]>, green: f32| {
        let [red, middle, blue] = found.expect("a sound picture");
        assert_eq!(red, 0.0);
        assert!((middle - green).abs() < 1e-6 && (blue - 1.0).abs() < 1e-6, "{middle} {blue}");
    };
    // ((0.2 + 0.055) / 1.055)^2.4
    near(value(eight(), &encoded), 0.033_104_77);
    near(value(sixteen(), &encoded), 0.033_104_77);
    near(value(eight(), &raw), 0.2);
    near(value(sixteen(), &raw), 0.2);
    near(value(float(), &encoded), 0.2);
    assert_eq!(value(half, &encoded), Some([0.0; 3]));
}

#[test]
fn alpha_is_left_out_unless_it_is_asked_for() {
    let of = |channel| BitmapOptions { channel, ..BitmapOptions::default() };
    let color = || Samples::U8(vec![255, 0, 0, 51]);
    let texture = single(color(), 4, &of(None)).expect("a sound picture");
    assert_eq!(texture.eval(Vec2::ZERO).rgb(), [1.0, 0.0, 0.0]);
    assert_eq!(texture.texels.memory_bytes(), 3, "and takes no memory");
    let scalar = |samples, channels, channel| {
        single(samples, channels, &of(channel)).map(|texture| texture.eval_scalar(Vec2::ZERO))
    };
    assert_eq!(scalar(color(), 4, Some(Channel::Alpha)), Some(0.2), "alpha is linear");
    assert_eq!(scalar(color(), 4, Some(Channel::Red)), Some(1.0));
    assert_eq!(scalar(color(), 4, Some(Channel::Blue)), Some(0.0));
    let grey = || Samples::U8(vec![255, 51]);
    assert_eq!(scalar(grey(), 2, None), Some(1.0));
    assert_eq!(scalar(grey(), 2, Some(Channel::Green)), Some(1.0), "grey is all colours");
    assert_eq!(scalar(grey(), 2, Some(Channel::Alpha)), Some(0.2));
    assert_eq!(scalar(Samples::U8(vec![1]), 1, Some(Channel::Alpha)), None);
}

#[test]
fn the_mean_of_codes_is_that_of_their_values() {
    let options = BitmapOptions::default();
    for channels in [1, 3] {
        let codes = (0..6 * channels).map(|i| i * 83 % 256);
        let narrow = Samples::U8(codes.clone().map(|code| code as u8).collect());
        let wide = Samples::U16(codes.map(|code| code as u16 * 257).collect());
        for samples in [narrow, wide] {
            let (width, height) = (3, 2);
            let bitmap =
                Bitmap { width, height, channels, samples, srgb: true, ..Bitmap::default() };
            let texture = BitmapTexture::new(bitmap, &options).expect("a sound picture");
            let centre =
                |index: u8| Vec2::new(f32::from(index % 3) + 0.5, f32::from(index / 3) + 0.5);
            let colors = (0..6).map(|index| texture.eval(centre(index) / Vec2::new(3.0, 2.0)));
            let sum: Spectrum = colors.sum();
            for (found, sum) in texture.mean().rgb().into_iter().zip(sum.rgb()) {
                assert!((found - sum / 6.0).abs() < 1e-6, "{found}, not {}", sum / 6.0);
            }
        }
    }
}

#[test]
fn the_mean_and_the_texels_are_those_of_the_picture() {
    let samples = Samples::F32(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let bitmap = Bitmap { width: 3, height: 2, channels: 1, samples, ..Bitmap::default() };
    let texture = BitmapTexture::new(bitmap, &BitmapOptions::default()).expect("a sound picture");
    assert_eq!(texture.mean().rgb(), [3.5; 3]);
    assert_eq!(texture.resolution(), [3, 2]);
    assert_eq!((texture.texel_luminance(2, 0), texture.texel_luminance(0, 1)), (3.0, 4.0));
    for (column, row) in [(0, 0), (2, 0), (1, 1)] {
        let centre = Vec2::new((column as f32 + 0.5) / 3.0, (row as f32 + 0.5) / 2.0);
        let expected = texture.texel_luminance(column, row);
        assert!((texture.eval_scalar(centre) - expected).abs() < 1e-6);
    }
}

#[test]
fn no_coordinate_leaves_the_picture() {
    let values =
        [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX, -1e-9, 1e-40, 1.0, 16_777_217.0];
    for wrap in [WrapMode::Repeat, WrapMode::Mirror, WrapMode::Clamp] {
        for filter in [FilterMode::Bilinear, FilterMode::Nearest] {
            let options = BitmapOptions { filter, wrap, ..BitmapOptions::default() };
            let texture = BitmapTexture::new(recorded_bitmap(), &options).expect("a sound picture");
            for uv in values.iter().flat_map(|&u| values.map(|v| Vec2::new(u, v))) {
                // This only checks that none of these calls panics.
                let color = texture.eval(uv);
                let _ = (texture.eval_scalar(uv), texture.gradient(uv));
                assert!(
                    !uv.is_finite() || color.is_finite(),
                    "{wrap:?} {filter:?} {uv}: {color:?}"
                );
            }
        }
    }
}

/// A PNG file of 2×1 pixels, one dark and one white.
fn png() -> Vec<u8> {
    let mut picture = Picture::new(2, 1);
    for name in ["R", "G", "B"] {
        picture.push(name, vec![0.033_104_77, 1.0]);
    }
    encode(&picture, FileFormat::Png, &EncodeOptions::default()).expect("the picture is sound")
}

fn node() -> TestNode {
    TestNode::new(Class::Texture, "bitmap").file("picture.png", png())
}

#[test]
fn a_file_is_read_with_its_options() {
    let first = Vec2::new(0.25, 0.5);
    let node = node().string("filename", "picture.png");
    let texture = node.build_cleanly(build);
    assert!((texture.eval(first).rgb()[0] - 0.033_104_77).abs() < 1e-6);
    let matrix = DMat4::from_translation(DVec3::new(0.5, 0.0, 0.0));
    let options = node
        .with("raw", Value::Boolean(true))
        .with("to_uv", Value::transform(matrix))
        .string("filter_type", "nearest")
        .string("wrap_mode", "mirror")
        .string("format", "fp16");
    let texture = options.build_cleanly(build);
    assert_eq!(texture.eval(first).rgb(), [1.0; 3]);
    assert!((texture.eval(-first).rgb()[0] - 0.2).abs() < 1e-6, "moved, reversed and raw");
}

#[test]
fn what_is_wrong_with_a_file_is_told_by_fault() {
    let mut cut = png();
    cut.truncate(cut.len() / 2);
    let node = || node().file("cut.png", cut.clone()).file("text.png", b"no picture".to_vec());
    let cases = [
        (node().string("filename", "absent.png"), Fault::Io),
        (node(), Fault::MissingParameter),
        (node().string("filename", "cut.png"), Fault::Syntax),
        (node().string("filename", "text.png"), Fault::Unsupported),
        (node().string("filename", "picture.png").string("channel", "a"), Fault::BadValue),
        (
            node()
                .string("filename", "picture.png")
                .with("to_uv", Value::transform(DMat4::from_scale(DVec3::splat(f64::NAN)))),
            Fault::BadValue,
        ),
    ];
    for (node, expected) in cases {
        assert!(node.build(build).is_none());
        let faults: Vec<Fault> = node.findings().iter().map(|found| found.fault).collect();
        assert_eq!(faults, [expected], "{:?}", node.findings());
    }
}
