//! The meshes.

use std::f64::consts::{FRAC_PI_2, TAU};

use etendue::mesh::TriangleMesh;
use glam::DVec3;

use super::patch::{self, Grid};

/// A (2, 3) torus knot of half height 1 about the z axis.
pub(super) fn knot() -> Vec<u8> {
    const RADIUS: f64 = 1.0;
    const SWING: f64 = 0.42;
    let angles = |t: f64| (2.0 * TAU * t, 3.0 * TAU * t);
    // The knot lies on a torus, whose normal is never parallel to the curve.
    let across = |t: f64| {
        let (around, over) = angles(t);
        DVec3::new(over.cos() * around.cos(), over.cos() * around.sin(), over.sin())
    };
    let curve = |t: f64| {
        let (around, _) = angles(t);
        DVec3::new(around.cos(), around.sin(), 0.0) * RADIUS + across(t) * SWING
    };
    let mut mesh = TriangleMesh::default();
    let grid = Grid { columns: 300, rows: 28, closed_u: true, closed_v: true };
    patch::tube(&mut mesh, grid, 0.24, curve, across);
    patch::file(&mesh)
}

/// A hollow ball of radius 1 around the origin: rods that wind from an upper ring to a lower ring,
/// half of them in each direction, and a ring between.
pub(super) fn basket() -> Vec<u8> {
    const RODS: u32 = 9;
    /// The latitude of the upper ring; the lower ring is its mirror image.
    const LATITUDE: f64 = 1.05;
    const ROD_RADIUS: f64 = 0.045;
    let mut mesh = TriangleMesh::default();
    let open = Grid { columns: 40, rows: 8, closed_u: false, closed_v: true };
    for rod in 0..RODS {
        for handedness in [-1.0, 1.0] {
            let start = TAU * f64::from(rod) / f64::from(RODS);
            let curve = move |t: f64| {
                on_sphere(LATITUDE * (2.0 * t - 1.0), start + handedness * TAU * 0.42 * t)
            };
            patch::tube(&mut mesh, open, ROD_RADIUS, curve, curve);
        }
    }
    let closed = Grid { columns: 64, rows: 10, closed_u: true, closed_v: true };
    for latitude in [-LATITUDE, 0.0, LATITUDE] {
        let curve = move |t: f64| on_sphere(latitude, TAU * t);
        patch::tube(&mut mesh, closed, ROD_RADIUS * 1.25, curve, |_| DVec3::Y);
    }
    patch::file(&mesh)
}

fn on_sphere(latitude: f64, longitude: f64) -> DVec3 {
    let (height, radius) = latitude.sin_cos();
    DVec3::new(radius * longitude.cos(), height, radius * longitude.sin())
}

/// A photographer's backdrop: a floor at y = 0 that bends up into a wall at z = -4, 24 wide.
pub(super) fn backdrop() -> Vec<u8> {
    const HALF_WIDTH: f64 = 12.0;
    const FRONT: f64 = 8.0;
    const BEND: f64 = 3.0;
    const BACK: f64 = -4.0;
    const HEIGHT: f64 = 12.0;
    let center = DVec3::new(0.0, BEND, BACK + BEND);
    let profile = |v: f64| {
        if v < 0.25 {
            DVec3::new(0.0, 0.0, FRONT + (center.z - FRONT) * v * 4.0)
        } else if v < 0.75 {
            let (sin, cos) = (FRAC_PI_2 * (v - 0.25) * 2.0).sin_cos();
            center - DVec3::new(0.0, cos, sin) * BEND
        } else {
            DVec3::new(0.0, BEND + (HEIGHT - BEND) * (v - 0.75) * 4.0, BACK)
        }
    };
    let mut mesh = TriangleMesh::default();
    let grid = Grid { columns: 1, rows: 64, closed_u: false, closed_v: false };
    patch::add(&mut mesh, grid, |u, v| profile(v) + DVec3::X * HALF_WIDTH * (2.0 * u - 1.0));
    patch::file(&mesh)
}
