//! Pictures from functions of two variables.

use etendue::image::{BitDepth, EncodeOptions, FileFormat, Picture, encode, srgb};

/// Width and height of every picture.
#[derive(Clone, Copy)]
pub(super) struct Size {
    pub(super) width: u32,
    pub(super) height: u32,
}

/// A PNG file with 8 bits per sample of sRGB values in [0, 1] at (u, v) in [0, 1]², v upwards.
pub(super) fn color(size: Size, paint: impl Fn(f64, f64) -> [f64; 3]) -> Vec<u8> {
    let values = sample(size, paint);
    // Round here, so that a difference in the last bit between machines changes no byte.
    let linear =
        |value: f64| srgb::srgb_u8_to_linear((value.clamp(0.0, 1.0) * 255.0).round() as u8);
    let channels = ["R", "G", "B"].into_iter().enumerate();
    let planes = channels
        .map(|(channel, name)| (name, values.iter().map(|value| linear(value[channel])).collect()));
    png(size, planes, BitDepth::Eight)
}

/// A grey PNG file with 16 bits per sample of values in [0, 1] at (u, v) in [0, 1]², v upwards.
pub(super) fn grey(size: Size, paint: impl Fn(f64, f64) -> f64) -> Vec<u8> {
    let values = sample(size, paint);
    let linear = |value: f64| {
        let rounded = (value.clamp(0.0, 1.0) * 65535.0).round() / 65535.0;
        srgb::srgb_to_linear(rounded as f32)
    };
    let plane = values.into_iter().map(linear).collect();
    png(size, [("Y", plane)].into_iter(), BitDepth::Sixteen)
}

fn sample<T>(size: Size, paint: impl Fn(f64, f64) -> T) -> Vec<T> {
    let center = |index: u32, count: u32| (f64::from(index) + 0.5) / f64::from(count);
    let rows = 0..size.height;
    let pixels = rows.flat_map(|y| (0..size.width).map(move |x| (x, y)));
    pixels.map(|(x, y)| paint(center(x, size.width), 1.0 - center(y, size.height))).collect()
}

fn png(
    size: Size,
    planes: impl Iterator<Item = (&'static str, Vec<f32>)>,
    bit_depth: BitDepth,
) -> Vec<u8> {
    let mut picture = Picture::new(size.width, size.height);
    for (name, plane) in planes {
        picture.push(name, plane);
    }
    let options = EncodeOptions { bit_depth, ..EncodeOptions::default() };
    encode(&picture, FileFormat::Png, &options).expect("its channels are as large as it")
}
