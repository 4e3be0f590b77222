//! The small pictures and grids of the test scenes in `crates/cli/tests/references`.

use std::f64::consts::{PI, TAU};

use etendue::image::{EncodeOptions, FileFormat, Picture, encode};

use super::paint::{self, Size};
use super::volumes::grid_file;

const TILES: Size = Size { width: 16, height: 16 };

/// Rounds to steps so coarse that differences in the last bit between machines do not matter.
fn round(value: f64) -> f32 {
    ((value * 1024.0).round() / 1024.0) as f32
}

/// Four tiles of different colours with dark joints.
pub(super) fn tiles() -> Vec<u8> {
    paint::color(TILES, |u, v| {
        let [column, row] = [u, v].map(|place| (2.0 * place).floor());
        let is_joint = [u, v].iter().any(|place| (2.0 * place).fract() < 0.12);
        match (is_joint, (column + 2.0 * row) as u32) {
            (true, _) => [0.15, 0.15, 0.18],
            (_, 0) => [0.85, 0.35, 0.25],
            (_, 1) => [0.35, 0.75, 0.45],
            (_, 2) => [0.3, 0.45, 0.85],
            _ => [0.85, 0.8, 0.5],
        }
    })
}

/// The normals of gentle waves, as a normal map.
pub(super) fn normals() -> Vec<u8> {
    paint::color(TILES, |u, v| {
        let (x, y) = (0.4 * (TAU * u).cos(), 0.4 * (TAU * v).sin());
        let z = (1.0 - x * x - y * y).sqrt();
        [x, y, z].map(|coordinate| 0.5 + 0.5 * coordinate)
    })
}

/// A horizon that is brighter than the zenith, dark ground, and a small light.
pub(super) fn environment() -> Vec<u8> {
    let (width, height) = (32, 16);
    let mut picture = Picture::new(width, height);
    let color = |x: u32, y: u32| {
        let elevation = 1.0 - (f64::from(y) + 0.5) / f64::from(height) * 2.0;
        let turn = (TAU * f64::from(x) / f64::from(width)).sin();
        let ground = [0.12, 0.1, 0.08];
        let sky = [0.6, 0.65, 0.8].map(|value| value * (1.2 - 0.8 * elevation) + 0.1 * turn);
        let is_light = (9..=10).contains(&x) && (4..=5).contains(&y);
        let color = if elevation < 0.0 { ground } else { sky };
        color.map(|value| round(if is_light { value + 25.0 } else { value }))
    };
    let pixels: Vec<[f32; 3]> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| color(x, y))
        .collect();
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        picture.push(name, pixels.iter().map(|pixel| pixel[channel]).collect());
    }
    encode(&picture, FileFormat::Exr, &EncodeOptions::default())
        .expect("its channels are as large as it")
}

/// A cloud that is densest in the middle.
pub(super) fn cloud() -> Vec<u8> {
    grid_file([8, 8, 8], |[x, y, z]| {
        let waves = (PI * x).sin() * (PI * y).sin() * (PI * z).sin();
        round(waves * (0.7 + 0.3 * (9.0 * x + 5.0 * y).sin()))
    })
}

/// The signed distance to a ball with a dent.
pub(super) fn distance() -> Vec<u8> {
    grid_file([9, 9, 9], |place| {
        let to = |middle: [f64; 3]| {
            let squares = place.iter().zip(middle).map(|(a, b)| (a - b).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let (ball, dent) = (to([0.5; 3]) - 0.36, to([0.5, 0.85, 0.7]) - 0.2);
        round(ball.max(-dent))
    })
}
