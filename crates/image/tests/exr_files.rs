//! OpenEXR files with features that our writer lacks: tiles, levels, parts, compressions, types.

use etendue_image::{
    EncodeOptions, FileFormat, MetadataValue, Picture, Samples, decode, decode_exr_layers,
    decode_picture, encode,
};
use exr::prelude as exrs;
use exr::prelude::{Blocks, Compression, Vec2, WritableImage};

const SIZE: Vec2<usize> = Vec2(45, 37);

/// A value that half precision represents exactly, different for each pixel of a row and channel.
fn value(channel: usize, x: usize, y: usize) -> f32 {
    (x + 64 * channel) as f32 / 8.0 + (y % 4) as f32
}

/// A channel of the given number type.
fn channel(
    name: &str,
    index: usize,
    kind: exrs::SampleType,
) -> exrs::AnyChannel<exrs::FlatSamples> {
    let values = (0..SIZE.area()).map(|pixel| value(index, pixel % SIZE.x(), pixel / SIZE.x()));
    let samples = match kind {
        exrs::SampleType::F16 => exrs::FlatSamples::F16(values.map(exrs::f16::from_f32).collect()),
        exrs::SampleType::F32 => exrs::FlatSamples::F32(values.collect()),
        exrs::SampleType::U32 => exrs::FlatSamples::U32(values.map(|v| (v * 8.0) as u32).collect()),
    };
    exrs::AnyChannel::new(name, samples)
}

type ForeignLayer = exrs::Layer<exrs::AnyChannels<exrs::FlatSamples>>;

/// A part with four channels of three number types.
fn layer(name: &str, compression: Compression, blocks: Blocks) -> ForeignLayer {
    use exrs::SampleType::{F16, F32, U32};
    let kinds = [("R", F16), ("G", F32), ("B", F16), ("id", U32)];
    let channels =
        kinds.into_iter().enumerate().map(|(index, (name, kind))| channel(name, index, kind));
    let encoding = exrs::Encoding { compression, blocks, line_order: exrs::LineOrder::Increasing };
    let mut attributes = exrs::LayerAttributes::named(name);
    attributes.layer_position = Vec2(-7, 11);
    let list = exrs::AnyChannels::sort(channels.collect());
    exrs::Layer::new(SIZE, attributes, encoding, list)
}

/// Encodes an image.
fn file<L>(image: &exrs::Image<L>) -> Vec<u8>
where
    for<'a> L: exr::image::write::layers::WritableLayers<'a>,
    for<'a> &'a exrs::Image<L>: WritableImage<'a, L>,
{
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// Checks every value of every channel.
fn check(bytes: &[u8], what: &str) {
    let picture = decode_exr_layers(bytes).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!((picture.width, picture.height), (45, 37), "{what}");
    assert_eq!(picture.data_origin, [-7, 11], "{what}");
    for (index, name) in ["R", "G", "B", "id"].into_iter().enumerate() {
        let scale = if name == "id" { 8.0 } else { 1.0 };
        for (pixel, &read) in picture.channel(name).unwrap().data.iter().enumerate() {
            let expected = value(index, pixel % SIZE.x(), pixel / SIZE.x()) * scale;
            assert_eq!(read, expected, "{what}: {name} at {pixel}");
        }
    }
    let bitmap = decode(bytes, "").unwrap();
    assert_eq!(bitmap.channels, 3);
    let Samples::F32(samples) = bitmap.samples else { panic!("{what}: floats expected") };
    assert_eq!(samples[3..6], [value(0, 1, 0), value(1, 1, 0), value(2, 1, 0)]);
}

#[test]
fn every_lossless_compression_in_lines_and_in_tiles() {
    use Compression::{PIZ, RLE, Uncompressed, ZIP1, ZIP16};
    for compression in [Uncompressed, RLE, ZIP1, ZIP16, PIZ] {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 9)), Blocks::Tiles(Vec2(64, 64))] {
            let image = exrs::Image::from_layer(layer("main", compression, blocks));
            check(&file(&image), &format!("{compression:?} {blocks:?}"));
        }
    }
}

#[test]
fn the_first_of_several_parts_is_read() {
    let first = layer("first", Compression::ZIP16, Blocks::ScanLines);
    let mut second = layer("second", Compression::RLE, Blocks::Tiles(Vec2(8, 8)));
    for channel in &mut second.channel_data.list {
        channel.sample_data = exrs::FlatSamples::F32(vec![-1.0; SIZE.area()]);
    }
    let attributes = exrs::ImageAttributes::with_size(SIZE);
    let image = exrs::Image::from_layers(attributes, vec![first, second]);
    check(&file(&image), "two parts");
}

#[test]
fn the_full_resolution_level_is_read() {
    let mut part = layer("main", Compression::ZIP1, Blocks::Tiles(Vec2(16, 16)));
    let list = std::mem::take(&mut part.channel_data.list);
    let levels = list.into_iter().map(|channel| {
        // Level sizes are halved and rounded down, to one pixel.
        let smaller = (1..6).map(|level| {
            let pixels = (SIZE.x() >> level).max(1) * (SIZE.y() >> level).max(1);
            match &channel.sample_data {
                exrs::FlatSamples::F16(_) => {
                    exrs::FlatSamples::F16(vec![Default::default(); pixels])
                }
                exrs::FlatSamples::F32(_) => exrs::FlatSamples::F32(vec![0.0; pixels]),
                exrs::FlatSamples::U32(_) => exrs::FlatSamples::U32(vec![0; pixels]),
            }
        });
        let level_data = std::iter::once(channel.sample_data.clone()).chain(smaller).collect();
        exrs::AnyChannel {
            name: channel.name.clone(),
            sample_data: exrs::Levels::Mip {
                rounding_mode: exr::math::RoundingMode::Down,
                level_data,
            },
            quantize_linearly: channel.quantize_linearly,
            sampling: channel.sampling,
        }
    });
    let list = exrs::AnyChannels::sort(levels.collect());
    let part = exrs::Layer::new(SIZE, part.attributes, part.encoding, list);
    check(&file(&exrs::Image::from_layer(part)), "mip map");
}

/// A file of one colour with these primaries and white.
fn with_chromaticities(points: [f32; 8]) -> Vec<u8> {
    let mut picture = Picture::new(1, 1);
    for (name, value) in [("R", 1.0), ("G", 0.5), ("B", 0.25), ("albedo.R", 1.0)] {
        picture.push(name, vec![value]);
    }
    for (name, value) in [("albedo.G", 0.5), ("albedo.B", 0.25), ("variance.R", 1.0)] {
        picture.push(name, vec![value]);
    }
    for name in ["variance.G", "variance.B", "A", "normal.X"] {
        picture.push(name, vec![1.0]);
    }
    let chromaticities = MetadataValue::Chromaticities(points);
    picture.metadata.push(("chromaticities".into(), chromaticities));
    encode(&picture, FileFormat::Exr, &EncodeOptions::default()).unwrap()
}

fn values(picture: &Picture, names: [&str; 3]) -> [f32; 3] {
    names.map(|name| picture.channel(name).unwrap().data[0])
}

#[test]
fn colours_of_other_primaries_become_those_of_bt709() {
    // Computed with the matrices of SMPTE RP 177 in double precision.
    let cases = [
        ("BT.2020", [0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329], BT2020),
        ("Display P3", [0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329], DISPLAY_P3),
        ("ACES AP0", [0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767], AP0),
    ];
    for (name, points, expected) in cases {
        let bytes = with_chromaticities(points);
        let picture = decode_picture(&bytes, "").unwrap();
        assert!(picture.warnings.is_empty(), "{name}");
        let bitmap = decode(&bytes, "").unwrap();
        let color = bitmap.to_color_image().pixels[0];
        let albedo = values(&picture, ["albedo.R", "albedo.G", "albedo.B"]);
        for found in [color, values(&picture, ["R", "G", "B"]), albedo] {
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-4, "{name}: {found} {expected}");
            }
        }
        // Variances and other layers are no colours; nor is raw data.
        assert_eq!(values(&picture, ["variance.R", "A", "normal.X"]), [1.0; 3]);
        assert_eq!(bitmap.to_raw(), [1.0, 0.5, 0.25, 1.0]);
        let written = encode(&picture, FileFormat::Exr, &EncodeOptions::default()).unwrap();
        assert_eq!(decode_picture(&written, "").unwrap(), picture, "{name}");
    }
}

const BT2020: [f32; 3] = [1.348_458, 0.439_812, 0.211_242];
const DISPLAY_P3: [f32; 3] = [1.112_47, 0.478_972, 0.215_613];
const AP0: [f32; 3] = [1.900_697, 0.381_651, 0.178_819];

#[test]
fn bt709_stays_the_same_to_the_bit_and_degenerate_primaries_are_said() {
    let plain = [1.0, 0.5, 0.25];
    let picture = decode_picture(
        &with_chromaticities([0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.329]),
        "",
    );
    let picture = picture.unwrap();
    assert_eq!(values(&picture, ["R", "G", "B"]), plain);
    assert!(picture.warnings.is_empty());
    for points in [[0.0; 8], [0.3; 8], [f32::NAN; 8]] {
        let bytes = with_chromaticities(points);
        let picture = decode_picture(&bytes, "").unwrap();
        assert_eq!(values(&picture, ["R", "G", "B"]), plain);
        let bitmap = decode(&bytes, "").unwrap();
        assert_eq!(bitmap.to_linear(), [1.0, 0.5, 0.25, 1.0]);
        for warnings in [picture.warnings, bitmap.warnings] {
            assert_eq!(warnings.len(), 1);
            assert!(warnings[0].contains("span no colour space"), "{warnings:?}");
        }
    }
}

/// Compresses the rows of a block.
type Compress = fn(&[u8]) -> Vec<u8>;

/// A file of luminance and chroma, of which every other row and column has none.
fn luminance_and_chroma(compress: Option<Compress>) -> Vec<u8> {
    let mut file = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let attribute = |file: &mut Vec<u8>, name: &str, kind: &str, value: &[u8]| {
        file.extend_from_slice(format!("{name}\0{kind}\0").as_bytes());
        file.extend_from_slice(&(value.len() as u32).to_le_bytes());
        file.extend_from_slice(value);
    };
    let mut channels = Vec::new();
    for (name, distance) in [("BY", 2_i32), ("RY", 2), ("Y", 1)] {
        channels.extend_from_slice(format!("{name}\0").as_bytes());
        for number in [1, 0, distance, distance] {
            channels.extend_from_slice(&number.to_le_bytes());
        }
    }
    channels.push(0);
    let numbers =
        |numbers: &[i32]| numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<_>>();
    let window = numbers(&[0, 0, 3, 3]);
    attribute(&mut file, "channels", "chlist", &channels);
    attribute(&mut file, "compression", "compression", &[if compress.is_some() { 3 } else { 0 }]);
    attribute(&mut file, "dataWindow", "box2i", &window);
    attribute(&mut file, "displayWindow", "box2i", &window);
    attribute(&mut file, "lineOrder", "lineOrder", &[0]);
    attribute(&mut file, "pixelAspectRatio", "float", &1.0_f32.to_le_bytes());
    attribute(&mut file, "screenWindowCenter", "v2f", &[0; 8]);
    attribute(&mut file, "screenWindowWidth", "float", &1.0_f32.to_le_bytes());
    file.push(0);
    let halves = |values: &[f32]| -> Vec<u8> {
        values.iter().flat_map(|value| exrs::f16::from_f32(*value).to_le_bytes()).collect()
    };
    // Chroma of zero on the left, and a red of twice the luminance on the right.
    let rows = (0..4).map(|row| {
        let luminance = halves(&[0.25, 0.25, 0.5, 0.5]);
        let chroma = [halves(&[0.0, 0.0]), halves(&[0.0, 1.0])].concat();
        if row % 2 == 0 { [chroma, luminance].concat() } else { luminance }
    });
    let blocks: Vec<Vec<u8>> = match compress {
        None => rows.collect(),
        Some(compress) => vec![compress(&rows.collect::<Vec<_>>().concat())],
    };
    let mut offset = file.len() + 8 * blocks.len();
    for block in &blocks {
        file.extend_from_slice(&(offset as u64).to_le_bytes());
        offset += 8 + block.len();
    }
    for (index, block) in blocks.iter().enumerate() {
        file.extend_from_slice(&numbers(&[index as i32, block.len() as i32]));
        file.extend_from_slice(block);
    }
    file
}

/// The compression of blocks of sixteen rows.
fn zip(raw: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let halves = [0, 1].map(|start| raw.iter().skip(start).step_by(2).copied());
    let mut bytes: Vec<u8> = halves.into_iter().flatten().collect();
    for index in (1..bytes.len()).rev() {
        bytes[index] = bytes[index].wrapping_sub(bytes[index - 1]).wrapping_add(128);
    }
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(&bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn luminance_and_chroma_become_red_green_and_blue() {
    for compress in [None, Some(zip as Compress)] {
        let bytes = luminance_and_chroma(compress);
        let picture = decode_picture(&bytes, "").unwrap();
        assert!(picture.warnings[0].contains("luminance and chroma"), "{:?}", picture.warnings);
        for row in [0, 1, 3] {
            let color = |column: usize| {
                ["R", "G", "B"].map(|name| picture.channel(name).unwrap().data[row * 4 + column])
            };
            let close = |found: [f32; 3], expected: [f32; 3]| {
                found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4)
            };
            assert!(close(color(0), [0.25; 3]), "{:?}", color(0));
            // Half of the way between the samples of the chroma.
            let green = |luminance: f32, red: f32| {
                (luminance - 0.212_639 * red - 0.072_192 * luminance) / 0.715_169
            };
            assert!(close(color(1), [0.375, green(0.25, 0.375), 0.25]), "{:?}", color(1));
            for column in [2, 3] {
                assert!(close(color(column), [1.0, green(0.5, 1.0), 0.5]), "{:?}", color(column));
            }
        }
        let bitmap = decode(&bytes, "").unwrap();
        assert_eq!((bitmap.channels, bitmap.warnings.len()), (3, 1));
        // No part of the file makes the reader panic.
        for index in 8..bytes.len() {
            for value in [0, 1, 3, 0x7f, 0xff] {
                let mut changed = bytes.clone();
                changed[index] = value;
                let _ = decode_picture(&changed, "");
            }
            let _ = decode_picture(&bytes[..index], "");
        }
    }
}
