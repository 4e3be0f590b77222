//! Small files written by other programs: palettes, run lengths, progressive scans, strips.

use etendue_image::{Samples, decode};

/// The picture in the golden files, 13 × 9 pixels: ramps of 20 per column, 28 per row and 12 per
/// diagonal.
fn ramp(x: u32, y: u32) -> [u32; 3] {
    [x * 20, y * 28, (x + y) * 12]
}

/// The maximum difference of an 8-bit file from the ramps.
fn max_difference(name: &str, bytes: &[u8]) -> u32 {
    let bitmap = decode(bytes, name).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!((bitmap.width, bitmap.height), (13, 9), "{name}");
    assert!(bitmap.srgb, "{name}");
    let Samples::U8(samples) = &bitmap.samples else { panic!("{name}: 8 bits expected") };
    let mut largest = 0;
    for (index, pixel) in samples.chunks_exact(bitmap.channels as usize).enumerate() {
        let expected = ramp(index as u32 % 13, index as u32 / 13);
        for (&sample, expected) in pixel.iter().zip(expected) {
            largest = largest.max(u32::from(sample).abs_diff(expected));
        }
        assert!(pixel.get(3).is_none_or(|&alpha| alpha == 255), "{name}");
    }
    largest
}

macro_rules! max_difference {
    ($name:literal) => {
        max_difference($name, include_bytes!(concat!("golden/", $name)))
    };
}

#[test]
fn lossless_files_are_exact() {
    assert_eq!(max_difference!("alpha.bmp"), 0);
    assert_eq!(max_difference!("alpha.tga"), 0);
    assert_eq!(max_difference!("rle.tga"), 0);
    assert_eq!(max_difference!("deflate.tif"), 0);
    assert_eq!(max_difference!("lzw.tif"), 0);
    assert_eq!(max_difference!("packbits.tif"), 0);
}

/// JPEG at quality 95. With chroma at half resolution, steep colour ramps are blurred.
#[test]
fn lossy_files_are_close() {
    assert!(max_difference!("progressive.jpg") <= 8);
    assert!(max_difference!("cmyk.jpg") <= 8);
    assert!(max_difference!("subsampled.jpg") <= 48);
}

#[test]
fn palettes_are_looked_up() {
    let png = decode(include_bytes!("golden/palette.png"), "").unwrap();
    let bmp = decode(include_bytes!("golden/palette.bmp"), "").unwrap();
    assert_eq!(png, bmp);
    assert_eq!(png.channels, 3);
    let Samples::U8(samples) = png.samples else { panic!("8 bits expected") };
    assert_eq!(samples[(4 * 13 + 6) * 3..][..3], [140, 126, 138]);
}

#[test]
fn one_bit_images_are_black_and_white() {
    let bitmap = decode(include_bytes!("golden/one_bit.png"), "").unwrap();
    let checks = (0..13 * 9).map(|index| ((index % 13 + index / 13) % 2 * 255) as u8);
    assert_eq!(bitmap.samples, Samples::U8(checks.collect()));
}
