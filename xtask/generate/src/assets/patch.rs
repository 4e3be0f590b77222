//! Meshes from functions of two variables.

use std::f64::consts::TAU;

use etendue::mesh::{TriangleMesh, write_ply};
use glam::{DVec3, Vec3};

/// A grid of quadrilaterals over a patch of surface.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    /// The number of steps of u.
    pub(super) columns: u32,
    /// The number of steps of v.
    pub(super) rows: u32,
    /// Whether the patch is closed along u.
    pub(super) closed_u: bool,
    /// Whether the patch is closed along v.
    pub(super) closed_v: bool,
}

/// Adds the patch `surface(u, v)`, (u, v) in [0, 1]², with normals ∂p/∂u × ∂p/∂v at its vertices.
pub(super) fn add(mesh: &mut TriangleMesh, grid: Grid, surface: impl Fn(f64, f64) -> DVec3) {
    let first = mesh.positions.len() as u32;
    let width = grid.columns + u32::from(!grid.closed_u);
    let height = grid.rows + u32::from(!grid.closed_v);
    for row in 0..height {
        for column in 0..width {
            let u = f64::from(column) / f64::from(grid.columns);
            let v = f64::from(row) / f64::from(grid.rows);
            mesh.positions.push(round(surface(u, v)));
            mesh.normals.push(round(normal(&surface, u, v)));
        }
    }
    let vertex = |column: u32, row: u32| first + (row % height) * width + column % width;
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            let (a, b) = (vertex(column, row), vertex(column + 1, row));
            let (c, d) = (vertex(column + 1, row + 1), vertex(column, row + 1));
            mesh.indices.extend([[a, b, c], [a, c, d]]);
        }
    }
}

/// A tube of this radius around a curve. `across` is any vector that is never parallel to the
/// curve.
pub(super) fn tube(
    mesh: &mut TriangleMesh,
    grid: Grid,
    radius: f64,
    curve: impl Fn(f64) -> DVec3,
    across: impl Fn(f64) -> DVec3,
) {
    add(mesh, grid, |along, around| {
        let tangent = curve(along + STEP) - curve(along - STEP);
        let side = across(along).cross(tangent).normalize();
        let up = side.cross(tangent).normalize();
        let (sin, cos) = (TAU * around).sin_cos();
        curve(along) + (side * cos + up * sin) * radius
    });
}

/// The mesh as a file.
pub(super) fn file(mesh: &TriangleMesh) -> Vec<u8> {
    debug_assert!(mesh.validate().is_ok());
    write_ply(mesh)
}

/// The step of central differences; their error is about its square.
const STEP: f64 = 1e-4;

fn normal(surface: &impl Fn(f64, f64) -> DVec3, u: f64, v: f64) -> DVec3 {
    let along_u = surface(u + STEP, v) - surface(u - STEP, v);
    let along_v = surface(u, v + STEP) - surface(u, v - STEP);
    along_u.cross(along_v).normalize()
}

/// Rounds to multiples of 2⁻¹⁴, so that a difference in the last bit between machines changes
/// nothing.
pub(super) fn round(vector: DVec3) -> Vec3 {
    ((vector * 16384.0).round() / 16384.0).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_tube_has_the_area_of_a_torus() {
        let mut mesh = TriangleMesh::default();
        let grid = Grid { columns: 256, rows: 64, closed_u: true, closed_v: true };
        let direction = |u: f64| DVec3::new((TAU * u).cos(), (TAU * u).sin(), 0.0);
        tube(&mut mesh, grid, 0.25, |u| direction(u) * 2.0, |_| DVec3::Z);
        // Pappus: the circumference of the circle times the length of its centre's path.
        let exact = TAU * 0.25 * TAU * 2.0;
        assert!((mesh.surface_area() / exact - 1.0).abs() < 5e-3);
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            let center = position.with_z(0.0).normalize() * 2.0;
            assert!((*normal - (*position - center) * 4.0).length() < 1e-3, "{normal}");
        }
    }
}
