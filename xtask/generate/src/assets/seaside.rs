//! What stands around a villa by the sea.

use etendue::mesh::TriangleMesh;
use glam::DVec3;

use super::implicit::{Lattice, mesh};
use super::noise::{fractal, mix, random, step, value};
use super::paint::{self, Size};
use super::patch::{self, Grid};
use super::solids::rounded_box;
use super::woods::Wood;

/// A cushion from (−1, −1, −1) to (1, 1, 1) that is meant to be made flat.
pub(super) fn cushion() -> Vec<u8> {
    let size = DVec3::splat(1.1);
    let cushion = mesh(&Lattice { low: -size, high: size, cell: 0.06 }, |place| {
        let bulge = 1.0 - 0.10 * (place.x * place.x + place.z * place.z);
        rounded_box(place, DVec3::new(1.0, bulge, 1.0), 0.28)
    });
    patch::file(&cushion)
}

/// A headland of rock, far away, 2 long and about 0.3 high.
pub(super) fn headland() -> Vec<u8> {
    let mut mesh = TriangleMesh::default();
    let grid = Grid { columns: 160, rows: 60, closed_u: false, closed_v: false };
    patch::add(&mut mesh, grid, |u, v| {
        let (x, z) = (2.0 * u - 1.0, 1.0 - 2.0 * v);
        let ridge = fractal(u * 4.0 + 3.0, v * 2.0, 64, 6);
        let shape = (1.0 - z * z).max(0.0) * step(-1.0, -0.1, x) * (1.0 - 0.7 * step(-0.2, 1.0, x));
        DVec3::new(x, 0.75 * ridge * ridge * shape - 0.02, 0.35 * z)
    });
    patch::file(&mesh)
}

/// The heights of waves; they repeat.
pub(super) fn waves() -> Vec<u8> {
    paint::grey(Size { width: 320, height: 320 }, |u, v| {
        let crest = |cells: u32, seed: u32| {
            let scale = f64::from(cells);
            let noise = value(u * scale, v * scale, cells, seed);
            1.0 - (2.0 * noise - 1.0).abs()
        };
        (crest(5, 1) + 0.55 * crest(11, 2) + 0.28 * crest(23, 3) + 0.12 * crest(47, 4)) / 1.95
    })
}

/// Slabs of travertine with narrow joints, four by four; they repeat.
pub(super) fn paving() -> Vec<u8> {
    paint::color(Size { width: 400, height: 400 }, |u, v| {
        let [column, row] = [u, v].map(|place| (4.0 * place).floor());
        let joint = [u, v].map(|place| 0.5 - ((4.0 * place).fract() - 0.5).abs());
        let gap = step(0.006, 0.016, joint[0].min(joint[1]));
        let tone = 0.06 * (random(column as u32, row as u32, 8) - 0.5);
        let cloud = 0.10 * (fractal(u * 10.0, v * 10.0, 10, 4) - 0.5);
        let vein = 0.07 * (value(u * 12.0, v * 64.0, 64, 9) - 0.5);
        let light = [0.80, 0.755, 0.69];
        std::array::from_fn(|channel| mix(0.38, light[channel] + tone + cloud + vein, gap))
    })
}

/// Boards of a deck or a wall, eight of them along v; they repeat nearly unseen.
pub(super) fn boards() -> Vec<u8> {
    const TEAK: Wood = Wood { light: [0.62, 0.42, 0.27], dark: [0.42, 0.26, 0.16], seed: 90 };
    paint::color(Size { width: 400, height: 400 }, |u, v| {
        let board = (8.0 * v).floor();
        let across = 8.0 * v - board;
        let gap = step(0.01, 0.05, 0.5 - (across - 0.5).abs());
        TEAK.color(2.0 * u, 0.35 * across, board as u32).map(|value| value * (0.25 + 0.75 * gap))
    })
}
