//! The grain of wood.

use super::noise::{mix, random, step, value};
use super::paint::{self, Size};

/// A kind of wood, with sRGB colours of its spring and summer growth.
#[derive(Clone, Copy)]
pub(super) struct Wood {
    pub(super) light: [f64; 3],
    pub(super) dark: [f64; 3],
    pub(super) seed: u32,
}

impl Wood {
    /// The colour at a place of a board; boards differ by their number.
    pub(super) fn color(self, along: f64, across: f64, board: u32) -> [f64; 3] {
        let offset = random(board, 0, self.seed) * 40.0;
        let (along, across) = (along + offset, across + 0.37 * offset);
        let bend = layered(along * 0.7, across * 0.9, self.seed);
        let ring = (across * 5.0 + bend * 4.0).rem_euclid(1.0);
        // Light in spring, darker towards the end of the summer, then a sharp edge.
        let late = step(0.15, 0.9, ring) * (1.0 - step(0.9, 1.0, ring));
        let fibre = value(along * 5.0, across * 70.0, PERIOD, self.seed + 1) - 0.5;
        let pore = value(along * 9.0, across * 110.0, PERIOD, self.seed + 2);
        let pores = 0.22 * step(0.78, 0.95, pore);
        let tone = 1.0 + 0.16 * (random(board, 1, self.seed) - 0.5);
        let cloud = layered(along * 1.3, across * 1.7, self.seed + 5) - 0.5;
        let depth = (0.62 * late + 0.38 * fibre + 0.5 * cloud + 0.15).clamp(0.0, 1.0);
        std::array::from_fn(|channel| {
            mix(self.light[channel], self.dark[channel], depth) * tone * (1.0 - pores)
        })
    }
}

/// More cells than any picture shows.
const PERIOD: u32 = 1 << 16;

/// Noise in [0, 1] of three octaves.
fn layered(x: f64, y: f64, seed: u32) -> f64 {
    let octave = |scale: f64, seed: u32| value(x * scale, y * scale, PERIOD, seed);
    (octave(1.0, seed) + 0.5 * octave(2.0, seed + 10) + 0.25 * octave(4.0, seed + 20)) / 1.75
}

/// The surface of a turned piece: u runs around, v along the grain. It repeats in both.
pub(super) fn turned(light: [f64; 3], dark: [f64; 3], seed: u32) -> Vec<u8> {
    paint::color(Size { width: 256, height: 256 }, |u, v| {
        let wave = value(u * 3.0, v * 3.0, 3, seed) - 0.5;
        let ring = (u * 6.0 + wave * 1.6).rem_euclid(1.0);
        let late = step(0.1, 0.9, ring) * (1.0 - step(0.9, 1.0, ring));
        let fibre = value(u * 64.0, v * 6.0, 192, seed + 1) - 0.5;
        let depth = (0.7 * late + 0.35 * fibre + 0.1).clamp(0.0, 1.0);
        std::array::from_fn(|channel| mix(light[channel], dark[channel], depth))
    })
}
