//! Every format and depth, written and read back.

use etendue_image::{
    BitDepth, EncodeOptions, ExrCompression, ExrPrecision, FileFormat, MetadataValue, Picture,
    Samples, ToneMap, Window, decode, decode_exr_layers, decode_picture, encode,
};

use proptest::prelude::*;

/// A picture of 37 × 21 pixels (not a multiple of any block) whose channels hold smooth ramps, each
/// with different values.
fn ramps(names: &[&str]) -> Picture {
    let (width, height) = (37, 21);
    let mut picture = Picture::new(width, height);
    for (channel, name) in names.iter().enumerate() {
        let value = |index: u32| {
            let (x, y) = (index % width, index / width);
            (x as f32 / 36.0 * 0.7 + y as f32 / 20.0 * 0.3) * (1.0 - 0.2 * channel as f32)
        };
        picture.push(*name, (0..width * height).map(value).collect());
    }
    picture
}

/// The maximum difference between two channels.
fn max_difference(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn exr_keeps_every_channel_and_all_metadata() {
    let mut picture = ramps(&["R", "G", "B", "A", "albedo.R", "normal.X", "depth.Z"]);
    picture.channels[6].data[5] = f32::INFINITY;
    picture.channels[0].data[0] = -1.5e-30;
    picture.data_origin = [-3, 12];
    picture.display_window = Window { x: -10, y: 2, width: 100, height: 90 };
    let matrix = std::array::from_fn(|index| index as f32);
    picture.metadata = vec![
        ("etendue:camera".into(), MetadataValue::Matrix4(matrix)),
        ("etendue:seconds".into(), MetadataValue::Double(1.0 / 3.0)),
        ("etendue:spp".into(), MetadataValue::Integer(-7)),
        ("etendue:title".into(), MetadataValue::Text("Étendue".into())),
        ("exposure".into(), MetadataValue::Float(0.25)),
        ("n".repeat(200), MetadataValue::Vector2([1.0, 2.0])),
        ("owner".into(), MetadataValue::Text(String::new())),
        ("uv".into(), MetadataValue::Vector3([1.0, 2.0, 3.0])),
        ("w".into(), MetadataValue::Matrix3([1.0; 9])),
    ];
    for exr_compression in [ExrCompression::None, ExrCompression::Zip] {
        let options = EncodeOptions { exr_compression, ..EncodeOptions::default() };
        let bytes = encode(&picture, FileFormat::Exr, &options).unwrap();
        let mut read = decode_exr_layers(&bytes).unwrap();
        for channel in &picture.channels {
            assert_eq!(read.channel(&channel.name), Some(channel), "{exr_compression:?}");
        }
        assert_eq!(read.channels.len(), picture.channels.len());
        let primaries = read.metadata.remove(0);
        assert_eq!(primaries.0, "chromaticities");
        assert_eq!(read.metadata, picture.metadata);
        assert_eq!((read.width, read.height), (37, 21));
        assert_eq!(read.data_origin, picture.data_origin);
        assert_eq!(read.display_window, picture.display_window);
        assert_eq!(encode(&picture, FileFormat::Exr, &options).unwrap(), bytes);
    }
}

#[test]
fn exr_halves_round_to_nearest_and_saturate() {
    let mut picture = ramps(&["Y"]);
    picture.channels[0].data[..4].copy_from_slice(&[1e9, -1e9, f32::INFINITY, 1.0 / 3.0]);
    let options = EncodeOptions { exr_precision: ExrPrecision::Half, ..EncodeOptions::default() };
    let bytes = encode(&picture, FileFormat::Exr, &options).unwrap();
    let bitmap = decode(&bytes, "").unwrap();
    assert_eq!(bitmap.channels, 1);
    assert!(!bitmap.srgb);
    let Samples::F16(samples) = bitmap.samples else { panic!("halves expected") };
    let values: Vec<f32> = samples.iter().map(|half| half.to_f32()).collect();
    assert_eq!(values[..4], [65504.0, -65504.0, f32::INFINITY, 0.333_251_95]);
    assert!(max_difference(&values[4..], &picture.channels[0].data[4..]) < 2.5e-4);
}

#[test]
fn pfm_keeps_color_and_grey_exactly() {
    for names in [&["R", "G", "B"][..], &["Y"]] {
        let picture = ramps(names);
        let bytes = encode(&picture, FileFormat::Pfm, &EncodeOptions::default()).unwrap();
        assert_eq!(decode_picture(&bytes, "a.pfm").unwrap(), picture);
    }
}

#[test]
fn hdr_keeps_eight_bits_of_the_largest_channel() {
    let picture = ramps(&["R", "G", "B"]);
    let bytes = encode(&picture, FileFormat::Hdr, &EncodeOptions::default()).unwrap();
    let read = decode_picture(&bytes, "").unwrap();
    for (a, b) in read.channels.iter().zip(&picture.channels) {
        assert!(max_difference(&a.data, &b.data) <= 1.0 / 128.0, "{}", a.name);
    }
}

/// The tolerances are in 8-bit steps.
#[test]
fn display_formats_are_accurate_to_their_depth() {
    use FileFormat::{Bmp, Png, Tiff};
    let cases: [(FileFormat, &[&str], BitDepth, f32); 10] = [
        (Png, &["R", "G", "B"], BitDepth::Eight, 0.51),
        (Png, &["R", "G", "B", "A"], BitDepth::Eight, 0.51),
        (Png, &["Y"], BitDepth::Eight, 0.51),
        (Png, &["Y", "A"], BitDepth::Eight, 0.51),
        (Png, &["R", "G", "B"], BitDepth::Sixteen, 0.002),
        (Png, &["R", "G", "B", "A"], BitDepth::Sixteen, 0.002),
        (Png, &["Y"], BitDepth::Sixteen, 0.002),
        (Tiff, &["R", "G", "B"], BitDepth::Eight, 0.51),
        (Tiff, &["R", "G", "B"], BitDepth::Sixteen, 0.002),
        (Bmp, &["R", "G", "B"], BitDepth::Eight, 0.51),
    ];
    for (format, names, bit_depth, tolerance) in cases {
        let mut picture = ramps(names);
        if names.contains(&"A") {
            picture.channels.last_mut().unwrap().data.fill(1.0);
        }
        let options = EncodeOptions { bit_depth, ..EncodeOptions::default() };
        let bytes = encode(&picture, format, &options).unwrap();
        let bitmap = decode(&bytes, "").unwrap();
        assert_eq!(bitmap.channels as usize, names.len(), "{format:?} {names:?}");
        assert_eq!(matches!(bitmap.samples, Samples::U8(_)), bit_depth == BitDepth::Eight);
        assert!(bitmap.srgb);
        let stored = bitmap.to_raw();
        for (channel, layer) in picture.channels.iter().enumerate() {
            let read: Vec<f32> =
                stored.iter().skip(channel).step_by(names.len()).copied().collect();
            let is_alpha = layer.name == "A";
            let encoded =
                |&v: &f32| if is_alpha { v } else { etendue_image::srgb::linear_to_srgb(v) };
            let expected: Vec<f32> = layer.data.iter().map(encoded).collect();
            let steps = max_difference(&read, &expected) * 255.0;
            assert!(steps <= tolerance, "{format:?} {names:?} {bit_depth:?}: {steps}");
        }
    }
}

/// The mean absolute error of the stored bytes, in steps.
fn jpeg_error(picture: &Picture, jpeg_quality: u8) -> f32 {
    let options = EncodeOptions { jpeg_quality, ..EncodeOptions::default() };
    let bytes = encode(picture, FileFormat::Jpeg, &options).unwrap();
    let read = decode(&bytes, "").unwrap();
    let exact = decode(&encode(picture, FileFormat::Png, &options).unwrap(), "").unwrap();
    assert_eq!(read.channels, exact.channels);
    let (read, exact) = (read.to_raw(), exact.to_raw());
    let sum: f32 = read.iter().zip(&exact).map(|(a, b)| (a - b).abs()).sum();
    sum / read.len() as f32 * 255.0
}

#[test]
fn jpeg_is_close_and_improves_with_quality() {
    for names in [&["R", "G", "B"][..], &["Y"]] {
        let picture = ramps(names);
        let (low, default, best) =
            (jpeg_error(&picture, 10), jpeg_error(&picture, 95), jpeg_error(&picture, 100));
        assert!(low > default && default > best, "{low} {default} {best}");
        assert!(default < 2.0, "{default}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// All bit patterns survive: NaN with payload, infinities, negative zero.
    #[test]
    fn exr_keeps_all_bits_at_any_size(
        width in 1_u32..70,
        height in 1_u32..40,
        channel_count in 1_usize..5,
        seed in any::<u32>(),
        is_compressed in any::<bool>(),
    ) {
        let mut picture = Picture::new(width, height);
        let mut state = seed;
        for channel in 0..channel_count {
            let data = (0..width * height).map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                // Every other value is constant, so that compression has an effect.
                f32::from_bits(if state & 0x10_0000 == 0 { state } else { 0x3f80_0000 })
            });
            picture.push(format!("c{channel}.X"), data.collect());
        }
        let exr_compression =
            if is_compressed { ExrCompression::Zip } else { ExrCompression::None };
        let options = EncodeOptions { exr_compression, ..EncodeOptions::default() };
        let bytes = encode(&picture, FileFormat::Exr, &options).unwrap();
        let read = decode_exr_layers(&bytes).unwrap();
        prop_assert_eq!(read.channels.len(), channel_count);
        for (read, written) in read.channels.iter().zip(&picture.channels) {
            prop_assert_eq!(&read.name, &written.name);
            let bits = |data: &[f32]| data.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&read.data), bits(&written.data));
        }
    }
}

/// With an alpha of one half, premultiplied colours are divided by it; with zero, they are kept.
#[test]
fn png_alpha_is_not_premultiplied() {
    let mut picture = Picture::new(2, 1);
    for name in ["R", "G", "B"] {
        picture.push(name, vec![0.25, 0.25]);
    }
    picture.push("A", vec![0.5, 0.0]);
    let options = EncodeOptions { bit_depth: BitDepth::Sixteen, ..EncodeOptions::default() };
    let bytes = encode(&picture, FileFormat::Png, &options).unwrap();
    let linear = decode(&bytes, "").unwrap().to_linear();
    let expected = [0.5, 0.5, 0.5, 0.5, 0.25, 0.25, 0.25, 0.0];
    assert!(max_difference(&linear, &expected) < 2e-5, "{linear:?}");
}

#[test]
fn exposure_and_tone_map_only_affect_display_formats() {
    let picture = ramps(&["R", "G", "B"]);
    let options =
        EncodeOptions { exposure: 1.0, tone_map: ToneMap::Agx, ..EncodeOptions::default() };
    for format in FileFormat::all() {
        let plain = encode(&picture, format, &EncodeOptions::default()).unwrap();
        let mapped = encode(&picture, format, &options).unwrap();
        assert_eq!(plain == mapped, format.is_linear(), "{format:?}");
    }
    let bytes = encode(&picture, FileFormat::Png, &options).unwrap();
    let shown = picture.to_color_image().unwrap().to_display(ToneMap::Agx, 1.0);
    let read = decode(&bytes, "").unwrap().to_color_image();
    let flat = |image: &etendue_image::ColorImage| image.pixels.as_flattened().to_vec();
    assert!(max_difference(&flat(&read), &flat(&shown)) < 0.005);
}

#[test]
fn single_pixels_fit_every_format_with_and_without_alpha() {
    for format in FileFormat::all() {
        for names in [&["Y"][..], &["Y", "A"], &["R", "G", "B"], &["R", "G", "B", "A"]] {
            for bit_depth in [BitDepth::Eight, BitDepth::Sixteen] {
                let mut picture = Picture::new(1, 1);
                for name in names {
                    picture.push(*name, vec![1.0]);
                }
                let options = EncodeOptions { bit_depth, ..EncodeOptions::default() };
                let bytes = encode(&picture, format, &options).unwrap();
                let image = decode(&bytes, "").unwrap().to_color_image();
                assert_eq!((image.width, image.height), (1, 1));
                let white = image.pixels[0].iter().all(|value| (value - 1.0).abs() < 0.01);
                assert!(white, "{format:?} {names:?} {bit_depth:?}: {image:?}");
            }
        }
    }
}

#[test]
fn pictures_that_do_not_fit_are_rejected() {
    let options = EncodeOptions::default();
    let reject = |picture: &Picture, format, expected: &str| {
        let error = encode(picture, format, &options).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    };
    reject(&Picture::new(2, 2), FileFormat::Exr, "no channels");
    reject(&Picture::new(2, 2), FileFormat::Png, "neither colour nor grey");
    reject(&ramps(&["normal.X", "depth.Z"]), FileFormat::Png, "only: normal.X, depth.Z");
    reject(&ramps(&["R\0"]), FileFormat::Exr, "not a name for a channel");
    reject(&ramps(&[""]), FileFormat::Exr, "not a name for a channel");
    let mut picture = ramps(&["R"]);
    picture.metadata.push(("tiles".into(), MetadataValue::Integer(1)));
    reject(&picture, FileFormat::Exr, "'tiles' describes the file itself");
    picture.metadata[0].0 = "x".repeat(256);
    reject(&picture, FileFormat::Exr, "not a name for an attribute");
    let mut picture = ramps(&["R"]);
    picture.data_origin = [i32::MAX, 0];
    reject(&picture, FileFormat::Exr, "32-bit coordinates");
    let mut picture = Picture::new(70_000, 1);
    picture.push("Y", vec![0.0; 70_000]);
    assert!(encode(&picture, FileFormat::Jpeg, &options).is_err());
}
