//! The pictures.

use std::f64::consts::TAU;

use super::noise::{fractal, mix, random, step, value};
use super::paint::{self, Size};

/// The number of courses of the brick wall and of bricks per course; whole bricks repeat at the
/// edges.
const COURSES: f64 = 8.0;
const BRICKS: f64 = 4.0;
const BRICK_SIZE: Size = Size { width: 384, height: 384 };

/// A place on the brick wall.
struct Brick {
    /// The indices of the course and of the brick in it.
    course: u32,
    index: u32,
    /// 0 in the mortar, 1 on the brick.
    face: f64,
}

/// Running bond: every other course is shifted by half a brick.
fn brick_at(u: f64, v: f64) -> Brick {
    // Hand-made bricks: no edge is quite straight.
    let wobble = |seed: u32| (value(u * 24.0, v * 24.0, 24, seed) - 0.5) * 0.05;
    let course = (v * COURSES).floor();
    let shift = if course.rem_euclid(2.0) < 0.5 { 0.0 } else { 0.5 };
    let along = u * BRICKS + shift;
    let index = along.floor();
    // Distances to the brick's edges, in units of the course height.
    let from_side = (0.5 - (along - index - 0.5).abs()) * COURSES / BRICKS + wobble(7);
    let from_bed = 0.5 - (v * COURSES - course - 0.5).abs() + wobble(8);
    let face = step(0.04, 0.12, from_side) * step(0.04, 0.12, from_bed);
    Brick { course: course as u32, index: index as u32 % BRICKS as u32, face }
}

/// Colours of the brick wall, sRGB.
pub(super) fn bricks_color() -> Vec<u8> {
    paint::color(BRICK_SIZE, |u, v| {
        let brick = brick_at(u, v);
        let tone = random(brick.index, brick.course, 3);
        let grain = fractal(u * 32.0, v * 32.0, 32, 3) - 0.5;
        let stain = fractal(u * 4.0, v * 4.0, 4, 3) - 0.5;
        let mortar = [0.70, 0.67, 0.62];
        let light = [0.71, 0.39, 0.28];
        let dark = [0.48, 0.22, 0.18];
        std::array::from_fn(|channel| {
            let clay = mix(dark[channel], light[channel], tone);
            mix(mortar[channel], clay, brick.face) + 0.16 * grain + 0.14 * stain
        })
    })
}

/// Heights of the brick wall: 0 is the deepest mortar, 1 the highest brick.
pub(super) fn bricks_height() -> Vec<u8> {
    paint::grey(BRICK_SIZE, |u, v| {
        let brick = brick_at(u, v);
        let level = 0.72 + 0.12 * random(brick.index, brick.course, 5);
        let rough = fractal(u * 32.0, v * 32.0, 32, 3) - 0.5;
        mix(0.25 + 0.12 * rough, level + 0.22 * rough, brick.face)
    })
}

/// A board sawn along a trunk: growth rings cut at a slant, sRGB.
pub(super) fn wood() -> Vec<u8> {
    const PLANKS: f64 = 5.0;
    paint::color(Size { width: 512, height: 320 }, |u, v| {
        let plank = (v * PLANKS).floor();
        let across = v * PLANKS - plank - 0.5;
        let seed = plank as u32;
        // Every plank comes from another part of the trunk.
        let along = u * 4.0 + random(seed, 0, 11) * 16.0;
        let bend = value(along * 0.5, f64::from(seed), 64, 12) - 0.5;
        let from_heart = ((across * 1.1 + bend * 0.9).powi(2) + 0.02).sqrt();
        let wave = value(along * 2.0, across * 6.0 + 3.0 * plank, 64, 13) * 0.06;
        let ring = (from_heart + wave) * 13.0;
        // Light in spring, darker towards the end of the summer, then a sharp edge.
        let season = ring - ring.floor();
        let late = step(0.25, 0.95, season) * (1.0 - step(0.95, 1.0, season));
        let fibre = value(along * 6.0, v * 160.0, 320, 14) - 0.5;
        let tone = random(seed, 1, 11) * 0.12 + 0.10 * fibre;
        let gap = step(0.0, 0.015, 0.5 - across.abs());
        let (light, dark) = ([0.80, 0.60, 0.40], [0.55, 0.35, 0.20]);
        std::array::from_fn(|channel| {
            (mix(light[channel], dark[channel], 0.8 * late) - tone) * mix(0.35, 1.0, gap)
        })
    })
}

/// A sheet with round holes in a hexagonal pattern: 1 is metal, 0 a hole.
pub(super) fn holes() -> Vec<u8> {
    const COLUMNS: f64 = 2.0;
    paint::grey(Size { width: 128, height: 128 }, |u, v| {
        // Two square lattices, shifted by half a cell and stretched into a hexagonal one.
        let ripple = |shift: f64| {
            let x = (TAU * (u * COLUMNS + shift)).cos();
            let y = (TAU * (v * COLUMNS + shift)).cos();
            x + y
        };
        let nearest = ripple(0.0).max(ripple(0.5));
        1.0 - step(0.9, 1.1, nearest)
    })
}
