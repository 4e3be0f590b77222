//! A bear of plush: its skin, and the fur on it.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use glam::DVec3;

use super::implicit::{Lattice, mesh};
use super::noise::{fractal_solid, mix, random};
use super::patch;
use super::solids::smooth_union;

const HAIRS: u32 = 130_000;
const HAIR_RADIUS: f64 = 0.0042;

/// A part of the bear.
struct Ellipsoid {
    middle: DVec3,
    radii: DVec3,
    /// How long the fur is.
    fur: f64,
}

const fn part(middle: [f64; 3], radii: [f64; 3], fur: f64) -> Ellipsoid {
    Ellipsoid { middle: DVec3::from_array(middle), radii: DVec3::from_array(radii), fur }
}

const BODY: [Ellipsoid; 9] = [
    part([0.0, 0.88, 0.0], [0.70, 0.84, 0.60], 0.17),
    part([0.0, 2.06, 0.06], [0.64, 0.57, 0.55], 0.15),
    part([0.0, 1.90, 0.52], [0.29, 0.22, 0.24], 0.07),
    part([-0.50, 2.52, 0.0], [0.23, 0.24, 0.12], 0.10),
    part([0.50, 2.52, 0.0], [0.23, 0.24, 0.12], 0.10),
    part([-0.74, 1.12, 0.24], [0.22, 0.46, 0.26], 0.14),
    part([0.74, 1.12, 0.24], [0.22, 0.46, 0.26], 0.14),
    part([-0.46, 0.30, 0.66], [0.27, 0.27, 0.52], 0.13),
    part([0.46, 0.30, 0.66], [0.27, 0.27, 0.52], 0.13),
];

/// About the distance to an ellipsoid.
fn distance(part: &Ellipsoid, place: DVec3) -> f64 {
    let scaled = (place - part.middle) / part.radii;
    let length = scaled.length();
    length * (length - 1.0) / (scaled / part.radii).length().max(1e-9)
}

/// The skin under the fur.
pub(super) fn skin() -> Vec<u8> {
    let lattice =
        Lattice { low: DVec3::new(-1.1, -0.1, -0.8), high: DVec3::new(1.1, 2.9, 1.3), cell: 0.035 };
    let skin = mesh(&lattice, |place| {
        let parts = BODY.iter().map(|part| distance(part, place));
        parts.fold(1e9, |all, part| smooth_union(all, part, 0.08))
    });
    patch::file(&skin)
}

/// The fur, as B-splines.
pub(super) fn fur() -> Vec<u8> {
    let weight = |part: &Ellipsoid| part.radii.element_product().powf(2.0 / 3.0);
    let total: f64 = BODY.iter().map(weight).sum();
    let mut text = String::new();
    for (index, part) in BODY.iter().enumerate() {
        let count = (f64::from(HAIRS) * weight(part) / total) as u32;
        for hair in 0..count {
            add_hair(&mut text, index, hair);
        }
    }
    text.into_bytes()
}

fn add_hair(text: &mut String, index: usize, hair: u32) {
    let part = &BODY[index];
    let chance = |kind: u32| random(hair, kind, 400 + index as u32);
    let up = 2.0 * chance(0) - 1.0;
    let (sin, cos) = (TAU * chance(1)).sin_cos();
    let flat = (1.0 - up * up).sqrt();
    let unit = DVec3::new(flat * cos, up, flat * sin);
    let root = part.middle + unit * part.radii;
    let is_buried = |(other, at): (usize, &Ellipsoid)| other != index && distance(at, root) < -0.01;
    if root.y < 0.02 || BODY.iter().enumerate().any(is_buried) {
        return;
    }
    let normal = (unit / part.radii).normalize();
    // Combed down and outwards, in tufts that lean together.
    let lean = |seed: u32| fractal_solid((root * 7.0 + 20.0).to_array(), 2, seed) - 0.5;
    let tuft = DVec3::new(lean(1), lean(2), lean(3)) * 1.5;
    let stray = DVec3::new(chance(2), chance(3), chance(4)) - 0.5;
    let comb = DVec3::new(0.0, -0.62, 0.12) + tuft + stray * 0.5;
    let length = part.fur * mix(0.7, 1.15, chance(5));
    let at = |along: f64| {
        let bend = comb - normal * comb.dot(normal).max(-0.35);
        root + (normal * (along - 0.25 * along * along) + bend * along * along * 0.75) * length
    };
    for (along, radius) in [(-0.35, 1.0), (0.0, 1.0), (0.4, 0.9), (0.8, 0.6), (1.2, 0.15)] {
        let place = at(along);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:.4} {:.4} {:.4} {:.5}",
            place.x,
            place.y.max(0.004),
            place.z,
            radius * HAIR_RADIUS
        );
    }
    text.push('\n');
}
