//! Volumes.

use super::noise::{fractal_solid, step};

/// Cells along x, y and z.
const SIZE: [u32; 3] = [40, 64, 40];

/// A plume of smoke that rises along y and widens.
pub(super) fn smoke() -> Vec<u8> {
    grid_file(SIZE, |[x, y, z]| density(x, y, z))
}

/// A file in Mitsuba's grid format, with values at the cell centres of the unit cube.
pub(super) fn grid_file(size: [u32; 3], value: impl Fn([f64; 3]) -> f32) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    for number in [1, size[0], size[1], size[2], 1] {
        bytes.extend(number.to_le_bytes());
    }
    for bound in [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0] {
        bytes.extend(bound.to_le_bytes());
    }
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                let cell = [x, y, z].into_iter().zip(size);
                let middle: Vec<f64> = cell
                    .map(|(index, count)| (f64::from(index) + 0.5) / f64::from(count))
                    .collect();
                bytes.extend(value([middle[0], middle[1], middle[2]]).to_le_bytes());
            }
        }
    }
    bytes
}

/// The density at a point of the unit cube, rounded so coarsely that differences in the last bit
/// between machines do not matter.
fn density(x: f64, y: f64, z: f64) -> f32 {
    // The higher the smoke, the farther it has drifted sideways and the larger its shreds.
    let sway = 0.13 * y;
    let axis_x = 0.5 + sway * (7.0 * y + 0.4).sin();
    let axis_z = 0.5 + sway * (5.5 * y + 1.9).sin();
    let shred = |seed: u32| fractal_solid([5.0 * x, 9.0 * y, 5.0 * z], 4, seed) - 0.5;
    let (to_x, to_z) = (x - axis_x + 0.5 * y * shred(1), z - axis_z + 0.5 * y * shred(2));
    let radius = 0.05 + 0.24 * y.sqrt() * y.sqrt().sqrt();
    let distance = (to_x * to_x + to_z * to_z).sqrt() / radius;
    let texture = step(0.25, 0.75, fractal_solid([9.0 * x, 13.0 * y, 9.0 * z], 4, 3));
    let ends = step(0.0, 0.06, y) * (1.0 - step(0.55, 1.0, y));
    let thinned = ends / (0.35 + 2.2 * y);
    let value = thinned * (1.0 - step(0.2, 1.0, distance)) * (0.25 + texture);
    (value * 256.0).round() as f32 / 256.0
}
