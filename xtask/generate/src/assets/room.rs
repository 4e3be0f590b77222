//! The parquet, the curtain and the picture of a room.

use std::f64::consts::TAU;

use etendue::mesh::TriangleMesh;
use glam::{DVec2, DVec3};

use super::noise::{fractal, mix, step, value};
use super::paint::{self, Size};
use super::patch::{self, Grid};
use super::woods::Wood;

/// Oak in a herringbone. The picture spans sixteen widths of a board, and repeats.
pub(super) fn parquet() -> Vec<u8> {
    const OAK: Wood = Wood { light: [0.66, 0.50, 0.33], dark: [0.49, 0.345, 0.21], seed: 120 };
    paint::color(Size { width: 1600, height: 1600 }, |u, v| {
        let board = herringbone(16.0 * u, 16.0 * v);
        let [along, across] = board.place;
        let edge = (0.5 - (across - 0.5).abs()).min(2.0 - (along - 2.0).abs());
        let joint = step(0.0, 0.035, edge);
        OAK.color(0.5 * along, 0.8 * across, board.number).map(|tone| tone * (0.4 + 0.6 * joint))
    })
}

/// A board of a herringbone, four by one.
struct Board {
    number: u32,
    /// Along it from 0 to 4, across it from 0 to 1.
    place: [f64; 2],
}

/// Boards lie in steps: in each row of unit squares, four squares of a board along x are followed by
/// four squares that belong to boards along y, and the next row is shifted by one.
fn herringbone(x: f64, y: f64) -> Board {
    let (column, row) = (x.floor(), y.floor());
    let phase = (column - row).rem_euclid(8.0);
    if phase < 4.0 {
        let start = column - phase;
        let number = (start.rem_euclid(16.0) + 31.0 * row.rem_euclid(16.0)) as u32;
        return Board { number, place: [x - start, y - row] };
    }
    // Along y: the square is the (7 − phase)th of its board.
    let start = row - (7.0 - phase);
    let number = 1000 + (column.rem_euclid(16.0) + 31.0 * start.rem_euclid(16.0)) as u32;
    Board { number, place: [y - start, x - column] }
}

/// A curtain from y = 0 to 1, one wide along z, in folds of depth about 0.1.
pub(super) fn curtain() -> Vec<u8> {
    let mut mesh = TriangleMesh::default();
    let grid = Grid { columns: 160, rows: 28, closed_u: false, closed_v: false };
    patch::add(&mut mesh, grid, |u, v| {
        let sway = 0.25 * (value(u * 3.0, v * 2.0, 64, 130) - 0.5);
        let phase = TAU * (7.0 * u + 1.2 * (value(u * 4.0, 0.3 * v, 64, 131) - 0.5) + 0.3 * sway);
        let depth = 0.035 + 0.030 * (1.0 - v);
        // Narrower where it is gathered at the top.
        let width = 0.92 + 0.08 * (1.0 - v);
        DVec3::new(depth * phase.sin(), v, (u - 0.5) * width + 0.25 * depth * (2.0 * phase).sin())
    });
    patch::file(&mesh)
}

/// An abstract painting: a sun over hills, in a few earthy colours.
pub(super) fn painting() -> Vec<u8> {
    paint::color(Size { width: 300, height: 400 }, |u, v| {
        let grain = 0.05 * (fractal(u * 60.0, v * 60.0, 60, 3) - 0.5);
        let hill = |height: f64, size: f64, seed: u32| {
            let edge = height + size * (value(u * 2.2 + 7.0, 0.0, 64, seed) - 0.5);
            1.0 - step(-0.004, 0.004, v - edge)
        };
        let sun = 1.0
            - step(0.148, 0.152, (DVec2::new(u, v * 4.0 / 3.0) - DVec2::new(0.6, 0.92)).length());
        let layers = [
            (sun, [0.80, 0.42, 0.22]),
            (hill(0.52, 0.24, 1), [0.78, 0.62, 0.45]),
            (hill(0.40, 0.28, 2), [0.45, 0.47, 0.38]),
            (hill(0.24, 0.26, 3), [0.19, 0.26, 0.27]),
        ];
        let paper = [0.90, 0.86, 0.78];
        layers
            .iter()
            .fold(paper, |below, (cover, color)| {
                std::array::from_fn(|channel| mix(below[channel], color[channel], *cover))
            })
            .map(|tone| tone + grain)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boards_of_the_herringbone_do_not_overlap() {
        // Each board covers as many of the unit squares as it is large.
        let mut squares = std::collections::HashMap::new();
        for square in 0..256_u32 {
            let [x, y] = [square % 16, square / 16].map(|at| f64::from(at) + 0.5);
            let board = herringbone(x, y);
            assert!((0.0..4.0).contains(&board.place[0]) && (0.0..1.0).contains(&board.place[1]));
            *squares.entry(board.number).or_insert(0) += 1;
        }
        assert!(squares.len() == 64 && squares.values().all(|count| *count == 4));
    }
}
