//! Files with alpha: straight in integer formats, premultiplied in OpenEXR.

use std::io::Cursor;

use etendue_image::{
    BitDepth, EncodeOptions, FileFormat, Picture, Samples, decode, decode_picture, encode,
};
use image::{DynamicImage, ImageFormat, Rgba, RgbaImage};

/// Translucent, opaque, and invisible with a colour.
const PIXELS: [[u8; 4]; 3] = [[200, 100, 50, 128], [1, 2, 254, 255], [200, 100, 50, 0]];

/// The pixels in a format, at eight or sixteen bits.
fn file(format: ImageFormat, depth: BitDepth) -> Vec<u8> {
    let mut picture = RgbaImage::new(3, 1);
    for (x, pixel) in PIXELS.into_iter().enumerate() {
        picture.put_pixel(x as u32, 0, Rgba(pixel));
    }
    let picture = DynamicImage::ImageRgba8(picture);
    let picture = match depth {
        BitDepth::Eight => picture,
        BitDepth::Sixteen => DynamicImage::ImageRgba16(picture.to_rgba16()),
    };
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Every format with alpha that is read, and the name that TGA needs.
fn files() -> Vec<(&'static str, Vec<u8>, BitDepth)> {
    use ImageFormat::{Bmp, Png, Qoi, Tga, Tiff, WebP};
    vec![
        ("a.png", file(Png, BitDepth::Eight), BitDepth::Eight),
        ("deep.png", file(Png, BitDepth::Sixteen), BitDepth::Sixteen),
        ("a.tif", file(Tiff, BitDepth::Eight), BitDepth::Eight),
        ("deep.tif", file(Tiff, BitDepth::Sixteen), BitDepth::Sixteen),
        ("a.tga", file(Tga, BitDepth::Eight), BitDepth::Eight),
        ("a.bmp", file(Bmp, BitDepth::Eight), BitDepth::Eight),
        ("a.webp", file(WebP, BitDepth::Eight), BitDepth::Eight),
        ("a.qoi", file(Qoi, BitDepth::Eight), BitDepth::Eight),
    ]
}

#[test]
fn integer_files_come_through_unchanged() {
    for (name, bytes, bit_depth) in files() {
        let picture = decode_picture(&bytes, name).unwrap();
        assert!(picture.straight_alpha, "{name}");
        assert_eq!(picture.source_depth, Some(bit_depth), "{name}");
        for format in [FileFormat::Png, FileFormat::Tiff] {
            let options = EncodeOptions { bit_depth, ..EncodeOptions::default() };
            let written = decode(&encode(&picture, format, &options).unwrap(), "").unwrap();
            match written.samples {
                Samples::U8(values) => assert_eq!(values, PIXELS.as_flattened(), "{name}"),
                Samples::U16(values) => {
                    let expected: Vec<u16> =
                        PIXELS.as_flattened().iter().map(|&value| u16::from(value) * 257).collect();
                    assert_eq!(values, expected, "{name}");
                }
                other => panic!("{name}: {other:?}"),
            }
        }
    }
}

#[test]
fn openexr_gets_premultiplied_colours_and_gives_them_back() {
    for (name, bytes, _) in files() {
        let picture = decode_picture(&bytes, name).unwrap();
        let options = EncodeOptions::default();
        let exr = encode(&picture, FileFormat::Exr, &options).unwrap();
        let read = decode_picture(&exr, "").unwrap();
        assert!(!read.straight_alpha);
        let red = &read.channel("R").unwrap().data;
        // The sRGB value 200 is 0.5776, and alpha is 128/255.
        assert!((red[0] - 0.28995).abs() < 1e-4 && red[2] == 0.0, "{name}: {red:?}");
        let png = decode(&encode(&read, FileFormat::Png, &options).unwrap(), "").unwrap();
        let Samples::U8(values) = png.samples else { panic!("bytes expected") };
        // What is invisible has no colour in OpenEXR.
        assert_eq!(values[..8], PIXELS.as_flattened()[..8], "{name}");
        assert_eq!(values[8..], [0, 0, 0, 0], "{name}");
    }
}

#[test]
fn formats_without_alpha_show_the_picture_over_black() {
    let picture = decode_picture(&file(ImageFormat::Png, BitDepth::Eight), "").unwrap();
    for format in [FileFormat::Bmp, FileFormat::Pfm, FileFormat::Hdr] {
        let bytes = encode(&picture, format, &EncodeOptions::default()).unwrap();
        let red = reds(&decode(&bytes, "").unwrap().to_color_image().pixels);
        assert!((red[0] - 0.28995).abs() < 0.005 && red[2] == 0.0, "{format:?}: {red:?}");
    }
}

#[test]
fn a_film_is_the_same_picture_as_png_and_as_openexr() {
    let mut film = Picture::new(16, 1);
    for name in ["R", "G", "B"] {
        film.push(name, (0..16).map(|x| x as f32 / 32.0).collect());
    }
    film.push("A", (0..16).map(|x| (x + 16) as f32 / 32.0).collect());
    let options = EncodeOptions { bit_depth: BitDepth::Sixteen, ..EncodeOptions::default() };
    let read = |format| {
        let bytes = encode(&film, format, &options).unwrap();
        reds(&decode_picture(&bytes, "").unwrap().to_color_image().unwrap().pixels)
    };
    for (a, b) in read(FileFormat::Png).iter().zip(read(FileFormat::Exr)) {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
}

fn reds(pixels: &[[f32; 3]]) -> Vec<f32> {
    pixels.iter().map(|pixel| pixel[0]).collect()
}
