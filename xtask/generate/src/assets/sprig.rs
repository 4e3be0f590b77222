//! A sprig of eucalyptus: round leaves in pairs along a bent stem.

use std::f64::consts::{PI, TAU};

use etendue::mesh::TriangleMesh;
use glam::{DQuat, DVec3};

use super::noise::random;
use super::patch::{self, Grid};

const PAIRS: u32 = 13;

/// The leaves.
pub(super) fn leaves() -> Vec<u8> {
    let mut mesh = TriangleMesh::default();
    for pair in 0..PAIRS {
        for side in 0..2 {
            add_leaf(&mut mesh, pair, side);
        }
    }
    patch::file(&mesh)
}

/// The stem, from the origin upwards.
pub(super) fn stem() -> Vec<u8> {
    let mut mesh = TriangleMesh::default();
    let grid = Grid { columns: 60, rows: 10, closed_u: false, closed_v: true };
    patch::tube(&mut mesh, grid, 0.014, stem_at, |_| DVec3::Z);
    patch::file(&mesh)
}

/// A place on the stem, which is about 2.4 long and leans over.
fn stem_at(along: f64) -> DVec3 {
    DVec3::new(0.85 * along * along, 2.2 * along - 0.35 * along * along, 0.22 * (2.4 * along).sin())
}

fn add_leaf(mesh: &mut TriangleMesh, pair: u32, side: u32) {
    let chance = |kind: u32| random(pair, side, 70 + kind) - 0.5;
    let along = (f64::from(pair) + 1.2 + 0.5 * chance(0)) / f64::from(PAIRS);
    let base = stem_at(along);
    let up = (stem_at(along + 0.01) - stem_at(along - 0.01)).normalize();
    // Each pair is turned by a quarter against the one before.
    let turn = 0.5 * PI * f64::from(pair % 2) + PI * f64::from(side) + 0.7 * chance(1);
    let outwards = DQuat::from_axis_angle(up, turn) * up.any_orthonormal_vector();
    let lift = 0.55 + 0.5 * chance(2) + 0.5 * along;
    let ahead = (outwards * lift.cos() + up * lift.sin()).normalize();
    let roll = DQuat::from_axis_angle(ahead, 0.8 * chance(3));
    let across = roll * ahead.cross(up).normalize();
    let face = across.cross(ahead);
    let size = (0.42 - 0.24 * along) * (1.0 + 0.3 * chance(4));
    let bend = 0.35 + 0.4 * chance(5);
    let grid = Grid { columns: 14, rows: 14, closed_u: false, closed_v: false };
    patch::add(mesh, grid, |u, v| {
        // Round, with a pointed tip; a short stalk lies between leaf and stem.
        let u = 0.005 + 0.99 * u;
        let width = (PI * u).sin().powf(0.62) * (1.0 - 0.22 * u);
        let beside = (v - 0.5) * width;
        let dish =
            bend * beside * beside - 0.30 * bend * u * u + 0.012 * (TAU * 3.0 * u).sin() * beside;
        base + (ahead * (u + 0.12) + across * beside + face * dish) * size
    });
}
