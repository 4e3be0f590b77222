//! The parts of a watch's movement. They lie in the plane y = 0 and have bevelled edges.

use std::f64::consts::TAU;

use etendue::mesh::TriangleMesh;
use glam::{DVec2, DVec3, Vec3Swizzles};

use super::implicit::{Lattice, mesh};
use super::noise::{step, value};
use super::paint::{self, Size};
use super::patch::{self, Grid};
use super::solids::{extrude, polygon, rounded_corners, smooth_difference};

/// A toothed wheel.
struct Wheel {
    teeth: f64,
    radius: f64,
    spokes: f64,
    /// Half of the thickness.
    half_height: f64,
}

impl Wheel {
    fn file(&self, cell: f64) -> Vec<u8> {
        let reach = self.radius + 0.12;
        let size = DVec3::new(reach, self.half_height + 0.05, reach);
        let wheel = mesh(&Lattice { low: -size, high: size, cell }, |place| {
            let figure = self.figure(DVec2::new(place.x, place.z));
            extrude(figure, place.y, self.half_height, 0.012)
        });
        patch::file(&wheel)
    }

    /// The wheel's distance in its plane.
    fn figure(&self, place: DVec2) -> f64 {
        let (distance, turn) = (place.length(), place.to_angle() / TAU);
        let tooth = (turn * self.teeth).rem_euclid(1.0) - 0.5;
        let height = TAU * self.radius / self.teeth * 0.62;
        let flank = step(0.33, 0.15, tooth.abs());
        let outline = (distance - (self.radius - height + height * flank)) * 0.6;
        let rim = self.radius - height - 0.13;
        let hub = 0.16 + 0.06 * self.radius;
        let spoke = (turn * self.spokes).rem_euclid(1.0) - 0.5;
        let beside = (spoke * TAU / self.spokes).sin().abs() * distance;
        let half_width = 0.05 + 0.045 * (1.0 - distance / self.radius);
        let window = (distance - rim).max(hub - distance).max(half_width - beside) + 0.015;
        let hole = 0.05 - distance;
        outline.max(-window).max(hole)
    }
}

/// The wheel that turns once an hour.
pub(super) fn center_wheel() -> Vec<u8> {
    Wheel { teeth: 72.0, radius: 1.7, spokes: 5.0, half_height: 0.06 }.file(0.013)
}

/// The wheel between it and the seconds.
pub(super) fn third_wheel() -> Vec<u8> {
    Wheel { teeth: 60.0, radius: 1.25, spokes: 4.0, half_height: 0.055 }.file(0.012)
}

/// A wheel with few teeth on an axle.
pub(super) fn pinion() -> Vec<u8> {
    let size = DVec3::new(0.34, 0.26, 0.34);
    let pinion = mesh(&Lattice { low: -size, high: size, cell: 0.008 }, |place| {
        let flat = DVec2::new(place.x, place.z);
        let turn = flat.to_angle() / TAU * 10.0;
        let leaf = step(0.38, 0.12, (turn.rem_euclid(1.0) - 0.5).abs());
        let outline = (flat.length() - (0.17 + 0.10 * leaf)) * 0.7;
        let axle = extrude(flat.length() - 0.06, place.y, 0.24, 0.02);
        extrude(outline, place.y, 0.15, 0.012).min(axle)
    });
    patch::file(&pinion)
}

/// The ring that swings to and fro, with screws that balance it.
pub(super) fn balance() -> Vec<u8> {
    const SCREWS: f64 = 16.0;
    let size = DVec3::new(1.32, 0.16, 1.32);
    let wheel = mesh(&Lattice { low: -size, high: size, cell: 0.012 }, |place| {
        let flat = DVec2::new(place.x, place.z);
        let distance = flat.length();
        let ring = extrude((distance - 1.08).abs() - 0.065, place.y, 0.085, 0.02);
        let arm = (flat.y.abs() - 0.07 - 0.05 * (1.0 - distance)).max(distance - 1.05);
        let arm = extrude(arm.min(distance - 0.2), place.y, 0.045, 0.012);
        let turn = (flat.to_angle() / TAU * SCREWS).rem_euclid(1.0) - 0.5;
        let beside = DVec2::new(turn * TAU / SCREWS * distance, place.y).length();
        let screw = extrude(beside - 0.058, distance - 1.19, 0.065, 0.015);
        ring.min(arm).min(screw)
    });
    patch::file(&wheel)
}

/// The spring of the balance: a spiral of a flat wire.
pub(super) fn hairspring() -> Vec<u8> {
    const TURNS: f64 = 9.0;
    let mut spring = TriangleMesh::default();
    let grid = Grid { columns: 1400, rows: 8, closed_u: false, closed_v: true };
    let curve = |along: f64| {
        let (sin, cos) = (TAU * TURNS * along).sin_cos();
        DVec3::new(cos, 0.0, sin) * (0.16 + 0.62 * along)
    };
    patch::tube(&mut spring, grid, 0.014, curve, |_| DVec3::Y);
    patch::file(&spring)
}

/// A bridge that holds the axles of the wheels.
pub(super) fn bridge() -> Vec<u8> {
    const OUTLINE: [(f64, f64); 9] = [
        (-3.9, -1.1),
        (-3.6, -2.6),
        (-2.2, -3.9),
        (-0.2, -4.3),
        (1.2, -3.9),
        (1.5, -2.9),
        (0.2, -2.2),
        (-1.4, -1.6),
        (-2.5, -0.5),
    ];
    const HOLES: [(f64, f64, f64); 3] =
        [(-0.55, -2.95, 0.21), (-2.6, -1.6, 0.19), (-2.2, -3.0, 0.24)];
    plate(&OUTLINE, &HOLES)
}

/// The cock that holds the balance.
pub(super) fn cock() -> Vec<u8> {
    const OUTLINE: [(f64, f64); 9] = [
        (4.3, 0.9),
        (4.4, 2.2),
        (3.6, 3.0),
        (2.9, 2.1),
        (2.1, 1.55),
        (1.55, 1.35),
        (1.5, 0.75),
        (2.2, 0.6),
        (3.3, 0.7),
    ];
    plate(&OUTLINE, &[(1.85, 1.05, 0.2), (3.75, 1.95, 0.24)])
}

/// A plate with round holes whose rims are sunk; holes are given by their middle and radius.
fn plate(outline: &[(f64, f64)], holes: &[(f64, f64, f64)]) -> Vec<u8> {
    const HALF_HEIGHT: f64 = 0.16;
    let corners: Vec<DVec2> = outline.iter().map(|&corner| corner.into()).collect();
    let outline = rounded_corners(&corners);
    let low = corners.iter().copied().reduce(DVec2::min).unwrap_or_default();
    let high = corners.iter().copied().reduce(DVec2::max).unwrap_or_default();
    let margin = DVec2::splat(0.1);
    let (low, high) = (low - margin, high + margin);
    let lattice = Lattice {
        low: DVec3::new(low.x, -HALF_HEIGHT - 0.06, low.y),
        high: DVec3::new(high.x, HALF_HEIGHT + 0.06, high.y),
        cell: 0.012,
    };
    let plate = mesh(&lattice, |place| {
        let flat = place.xz();
        let figure = polygon(flat, &outline);
        // A bevel at 45 degrees, as watchmakers polish it.
        let edge = (figure + place.y.abs() - HALF_HEIGHT + 0.07) * std::f64::consts::FRAC_1_SQRT_2;
        let slab = extrude(figure, place.y, HALF_HEIGHT, 0.02);
        let slab = smooth_difference(slab, -edge, 0.03);
        holes.iter().fold(slab, |rest, &(x, z, radius)| {
            let from = (flat - DVec2::new(x, z)).length();
            let sunk = (from - radius + 0.6 * (HALF_HEIGHT - place.y)).max(-0.03 - place.y);
            rest.max(-sunk.min(from - 0.6 * radius))
        })
    });
    patch::file(&plate)
}

/// The head of a screw of radius 1, with its slot.
pub(super) fn screw() -> Vec<u8> {
    let size = DVec3::new(1.1, 0.5, 1.1);
    let head = mesh(&Lattice { low: -size, high: size, cell: 0.035 }, |place| {
        let dome = extrude(place.xz().length() - 1.0, place.y, 0.4, 0.12);
        let slot = (place.z.abs() - 0.12).max(0.12 - place.y);
        dome.max(-slot)
    });
    patch::file(&head)
}

/// A jewel of radius 1 with a sink for the axle.
pub(super) fn jewel() -> Vec<u8> {
    let size = DVec3::new(1.1, 0.5, 1.1);
    let ring = mesh(&Lattice { low: -size, high: size, cell: 0.035 }, |place| {
        let distance = place.xz().length();
        let stone = extrude(distance - 1.0, place.y, 0.36, 0.2);
        let sink = (DVec2::new(distance, place.y - 0.62).length()) - 0.5;
        stone.max(-sink)
    });
    patch::file(&ring)
}

/// The heights of stippling: overlapping spots of fine circles. It repeats.
pub(super) fn stippling() -> Vec<u8> {
    const SPOTS: f64 = 4.0;
    paint::grey(Size { width: 512, height: 512 }, |u, v| {
        // The last spot whose circle covers the place lies on top.
        let mut height = 0.5;
        for row in -1..=5 {
            for column in -1..=5 {
                let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
                let middle = DVec2::new(f64::from(column) + shift, f64::from(row));
                let distance = (DVec2::new(u, v) * SPOTS - middle).length();
                if distance < 0.78 {
                    let rings = 0.5 + 0.5 * (distance * TAU * 11.0).cos();
                    height = 0.35 * rings + 0.65 * step(0.78, 0.60, distance);
                }
            }
        }
        height
    })
}

/// The heights of stripes across u, as a grinding wheel leaves them on bridges. They repeat.
pub(super) fn stripes() -> Vec<u8> {
    paint::grey(Size { width: 256, height: 64 }, |u, v| {
        let across = (u * 2.0).fract() - 0.5;
        let groove = 0.9 * (0.25 - across * across) * 4.0;
        groove + 0.06 * value(u * 96.0, v * 2.0, 96, 5)
    })
}
