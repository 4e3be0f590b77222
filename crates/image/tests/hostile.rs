//! Malformed files give errors: no panics, and no disproportionate memory or time.
#![allow(clippy::disallowed_methods, reason = "the corpus is read from disk")]

use std::path::Path;

use etendue_image::{
    BitDepth, EncodeOptions, ExrCompression, FileFormat, ImageError, Limits, Picture, decode,
    decode_exr_layers, decode_picture, decode_with_limits, encode,
};
use exr::prelude as exrs;
use exr::prelude::WritableImage;

/// Xorshift with a fixed seed.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound as u64) as usize
    }
}

fn picture(names: &[&str]) -> Picture {
    let mut picture = Picture::new(19, 18);
    for name in names {
        picture.push(*name, (0..19 * 18).map(|index| index as f32 / 400.0).collect());
    }
    picture
}

/// An OpenEXR file with a compression or tiling that our writer lacks.
fn foreign_exr(
    size: exrs::Vec2<usize>,
    compression: exrs::Compression,
    blocks: exrs::Blocks,
) -> Vec<u8> {
    let color = |position: exrs::Vec2<usize>| {
        let value = (position.x() * position.y()) as f32 / 400.0;
        (value, exr::prelude::f16::from_f32(value), position.x() as u32)
    };
    let channels = exrs::SpecificChannels::build()
        .with_channel("R")
        .with_channel("G")
        .with_channel("B")
        .with_pixel_fn(color);
    let encoding = exrs::Encoding { compression, blocks, line_order: exrs::LineOrder::Increasing };
    let attributes = exrs::LayerAttributes::named("main");
    let layer = exrs::Layer::new(size, attributes, encoding, channels);
    let mut bytes = std::io::Cursor::new(Vec::new());
    exrs::Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// Valid files of every format, with their names.
fn valid_files() -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    let options = EncodeOptions::default();
    let deep = EncodeOptions {
        bit_depth: BitDepth::Sixteen,
        exr_compression: ExrCompression::None,
        ..options
    };
    for format in FileFormat::all() {
        for (kind, names, options) in [
            ("colour", &["R", "G", "B"][..], &options),
            ("grey", &["Y"], &options),
            ("alpha", &["R", "G", "B", "A"], &deep),
        ] {
            let bytes = encode(&picture(names), format, options).unwrap();
            files.push((format!("{kind}.{}", format.extensions()[0]), bytes));
        }
    }
    let (lines, tiles) = (exrs::Blocks::ScanLines, exrs::Blocks::Tiles(exrs::Vec2(8, 7)));
    for (compression, blocks) in [
        (exrs::Compression::PIZ, lines),
        (exrs::Compression::RLE, lines),
        (exrs::Compression::ZIP1, tiles),
        (exrs::Compression::PXR24, tiles),
        (exrs::Compression::B44, lines),
    ] {
        let name = format!("{compression:?} {blocks:?}.exr");
        files.push((name, foreign_exr(exrs::Vec2(19, 18), compression, blocks)));
    }
    files.push(("plain.tga".into(), tga()));
    files.push(("plain.webp".into(), foreign(image::ImageFormat::WebP)));
    files.push(("plain.qoi".into(), foreign(image::ImageFormat::Qoi)));
    files.extend(golden_files());
    files
}

/// Files written by other programs.
fn golden_files() -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    paths.iter().map(|path| (name(path), std::fs::read(path).unwrap())).collect()
}

/// An uncompressed TGA of 19 × 18 pixels.
fn tga() -> Vec<u8> {
    let mut bytes = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 19, 0, 18, 0, 24, 0x20];
    bytes.extend((0..19 * 18 * 3).map(|index| index as u8));
    bytes
}

/// A file with alpha of a format that is only read.
fn foreign(format: image::ImageFormat) -> Vec<u8> {
    let pixel = |x: u32, y: u32| image::Rgba([x as u8, y as u8, (x * y) as u8, (200 + x) as u8]);
    let picture = image::RgbaImage::from_fn(19, 18, pixel);
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Decodes a file in every way. The result must be an error or a consistent image.
fn survive(bytes: &[u8], name: &str) {
    if let Ok(bitmap) = decode(bytes, name) {
        let expected = bitmap.width as usize * bitmap.height as usize * bitmap.channels as usize;
        assert_eq!(bitmap.samples.len(), expected, "{name}");
    }
    if let Ok(picture) = decode_picture(bytes, name) {
        // It can be written again, whatever its texts are. A malformed OpenEXR file may have two
        // channels of one name.
        let is_exr = bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]);
        assert!(is_exr || picture.validate().is_ok(), "{name}");
        assert!(is_exr || encode(&picture, FileFormat::Exr, &EncodeOptions::default()).is_ok());
    }
    if let Ok(picture) = decode_exr_layers(bytes) {
        // Only duplicate channel names in a malformed file are not rejected.
        assert!(!picture.channels.is_empty(), "{name}");
    }
}

#[test]
fn valid_files_are_read() {
    for (name, bytes) in valid_files() {
        let bitmap = decode(&bytes, &name).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(bitmap.width >= 13 && bitmap.height >= 9, "{name}");
    }
}

#[test]
fn truncated_files_do_not_panic() {
    let mut random = Random(0x5eed);
    for (name, bytes) in valid_files() {
        for _ in 0..60 {
            survive(&bytes[..random.below(bytes.len())], &name);
        }
        for length in 0..bytes.len().min(80) {
            survive(&bytes[..length], &name);
        }
    }
}

#[test]
fn corrupt_files_do_not_panic() {
    let mut random = Random(0xd157);
    for (name, bytes) in valid_files() {
        for _ in 0..200 {
            let mut bytes = bytes.clone();
            // Most errors are in the header.
            let range = if random.below(3) > 0 { bytes.len().min(400) } else { bytes.len() };
            for _ in 0..=random.below(4) {
                bytes[random.below(range)] = [0, 1, 0x7f, 0x80, 0xff, b' '][random.below(6)];
            }
            survive(&bytes, &name);
        }
    }
}

/// Large parts are decompressed on several threads, where panics must be caught as well.
#[test]
fn corrupt_blocks_do_not_panic_on_other_threads() {
    let mut random = Random(0x7472);
    let size = exrs::Vec2(300, 200);
    for compression in [exrs::Compression::B44, exrs::Compression::PIZ, exrs::Compression::RLE] {
        let bytes = foreign_exr(size, compression, exrs::Blocks::ScanLines);
        assert!(decode(&bytes, "").is_ok());
        for _ in 0..20 {
            let mut bytes = bytes.clone();
            for _ in 0..50 {
                let index = 2000 + random.below(bytes.len() - 2000);
                bytes[index] = random.below(256) as u8;
            }
            survive(&bytes, "");
        }
    }
}

#[test]
fn files_above_the_limits_are_too_large() {
    for (name, bytes) in valid_files() {
        let bitmap = decode(&bytes, &name).unwrap();
        let limits = Limits { samples: bitmap.samples.len() as u64 - 1, ..Limits::default() };
        let result = decode_with_limits(&bytes, &name, &limits);
        assert!(matches!(result, Err(ImageError::TooLarge { .. })), "{name}: {result:?}");
    }
}

/// Every file of the corpus is malformed in the way that its name says.
#[test]
fn the_corpus_is_rejected() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let error = decode(&bytes, name).expect_err(name);
        let is_unsupported = matches!(error, ImageError::Unsupported { .. });
        assert_eq!(is_unsupported, name.starts_with("unsupported_"), "{name}: {error}");
        count += 1;
    }
    assert!(count > 15, "{count}");
}
