//! Sampling a surface of revolution as a light: uniform in area up to the error of a table.

use super::RevSurface;
use crate::shape::ShapeSample;
use etendue_sampling::{AliasTable, warp};
use glam::{Vec2, Vec3};
use std::f64::consts::TAU;

/// Table cells per piece of the profile.
const CELLS_PER_PIECE: usize = 4;
/// The number of azimuths averaged over a circle.
const AZIMUTHS: usize = 16;

/// Cells along the profile. The density is linear within each.
#[derive(Clone, Debug)]
pub(super) struct AreaTable {
    cells: Vec<Cell>,
    table: AliasTable,
    sum: f64,
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    piece: u32,
    /// The range of v.
    v: [f32; 2],
    /// The area element per v and u at both ends, averaged over u.
    jacobian: [f32; 2],
}

impl Cell {
    fn area(&self) -> f64 {
        f64::from(self.v[1] - self.v[0]) * 0.5 * f64::from(self.jacobian[0] + self.jacobian[1])
    }
}

/// Builds the table of a surface and computes its area; no table if the area is zero.
pub(super) fn measure(surface: &RevSurface) -> (Option<AreaTable>, f32) {
    let mut cells = Vec::with_capacity(surface.pieces.len() * CELLS_PER_PIECE);
    for piece in 0..surface.pieces.len() {
        let place = |step: usize| step as f64 / CELLS_PER_PIECE as f64;
        let mean = |s: f64| {
            let azimuth = |i: usize| TAU * i as f64 / AZIMUTHS as f64;
            let jacobian = |i: usize| surface.jacobian(piece, s, azimuth(i));
            let sum: f32 = (0..AZIMUTHS).map(jacobian).sum();
            (sum / AZIMUTHS as f32, surface.v(piece, s) as f32)
        };
        let mut start = mean(0.0);
        for step in 1..=CELLS_PER_PIECE {
            let end = mean(place(step));
            let (piece, v, jacobian) = (piece as u32, [start.1, end.1], [start.0, end.0]);
            cells.push(Cell { piece, v, jacobian });
            start = end;
        }
    }
    let areas: Vec<f32> = cells.iter().map(|cell| cell.area() as f32).collect();
    let sum: f64 = cells.iter().map(Cell::area).sum();
    let table = AliasTable::new(&areas).ok().map(|table| AreaTable { cells, table, sum });
    (table, sum as f32)
}

impl AreaTable {
    /// The density per v.
    fn density(&self, cell: &Cell, v: f32) -> f64 {
        let width = cell.v[1] - cell.v[0];
        let [start, end] = cell.jacobian;
        let within = ((v - cell.v[0]) / width).clamp(0.0, 1.0);
        f64::from(start + (end - start) * within) / self.sum
    }

    /// The density per area at `v` in a cell. `jacobian` is the area element per u and v.
    fn pdf_in(&self, cell: &Cell, v: f32, jacobian: f32) -> f32 {
        let pdf = self.density(cell, v) / f64::from(jacobian);
        // Both are zero on the axis itself.
        (if pdf.is_finite() { pdf } else { 1.0 / self.sum }) as f32
    }

    /// The density per area with which [`Self::sample`] chooses a point with this coordinate and
    /// these derivatives.
    pub(super) fn pdf(&self, v: f32, dp_du: Vec3, dp_dv: Vec3) -> f32 {
        let after = self.cells.partition_point(|cell| cell.v[0] <= v);
        self.pdf_in(&self.cells[after.saturating_sub(1)], v, dp_du.cross(dp_dv).length())
    }

    /// Samples a point, with its density per area.
    pub(super) fn sample(&self, surface: &RevSurface, random: Vec2) -> ShapeSample {
        // One random number has enough bits for a few thousand cells.
        let (choice, u) = if self.table.len() <= 4096 {
            (self.table.sample(random.x), random.y)
        } else {
            (self.table.sample_2d(random), (random.y * 4096.0).fract())
        };
        let cell = &self.cells[choice.index];
        let within = warp::linear::sample(choice.rest, cell.jacobian[0], cell.jacobian[1]);
        let v = cell.v[0] + (cell.v[1] - cell.v[0]) * within;
        let piece = cell.piece as usize;
        let s = surface.piece_parameter(piece, f64::from(v));
        let azimuth = TAU * f64::from(u);
        let at = surface.at(piece, s, azimuth);
        ShapeSample {
            point: at.point,
            error: at.error,
            normal: at.normal,
            shading_normal: at.shading_normal,
            uv: at.uv,
            pdf: self.pdf_in(cell, v, surface.jacobian(piece, s, azimuth)),
        }
    }

    /// Memory use in bytes.
    pub(super) fn memory_bytes(&self) -> usize {
        // An entry of the alias table is as large as three numbers.
        self.cells.len() * (size_of::<Cell>() + 12)
    }
}
