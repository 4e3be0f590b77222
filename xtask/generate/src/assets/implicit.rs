//! Meshes of implicit surfaces.

use etendue::mesh::TriangleMesh;
use glam::{DVec2, DVec3};

use super::patch::round;

/// A box that is divided into cells.
pub(super) struct Lattice {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    /// The edge of a cell.
    pub(super) cell: f64,
}

/// The surface where `distance` is zero, within the lattice; the normals point to where it is
/// positive. The texture coordinates are x and z.
///
/// Naive surface nets (Gibson, "Constrained Elastic Surface Nets", 1998): one vertex in each cell
/// that the surface crosses, moved onto the surface by Newton's method.
pub(super) fn mesh(lattice: &Lattice, distance: impl Fn(DVec3) -> f64) -> TriangleMesh {
    let field = Field::sample(lattice, &distance);
    let mut mesh = TriangleMesh::default();
    let mut vertex_of_cell = vec![u32::MAX; field.values.len()];
    for index in field.cells() {
        let Some(start) = field.vertex(index) else { continue };
        let (place, normal) = project(&distance, start, lattice.cell);
        vertex_of_cell[field.flat(index)] = mesh.positions.len() as u32;
        mesh.positions.push(round(place));
        mesh.normals.push(round(normal));
        mesh.uvs.push(DVec2::new(place.x, place.z).as_vec2());
    }
    for index in field.cells() {
        for axis in 0..3 {
            field.add_quadrilateral(&mut mesh, &vertex_of_cell, index, axis);
        }
    }
    mesh
}

/// The distance at the corners of all cells.
struct Field {
    low: DVec3,
    cell: f64,
    /// Corners along each axis.
    counts: [usize; 3],
    values: Vec<f64>,
}

impl Field {
    fn sample(lattice: &Lattice, distance: impl Fn(DVec3) -> f64) -> Self {
        let size = (lattice.high - lattice.low) / lattice.cell;
        let counts = size.to_array().map(|cells| cells.ceil() as usize + 1);
        let mut field = Self { low: lattice.low, cell: lattice.cell, counts, values: Vec::new() };
        let corners = counts.map(|count| 0..count);
        for z in corners[2].clone() {
            for y in corners[1].clone() {
                for x in corners[0].clone() {
                    let place = field.corner([x, y, z]);
                    field.values.push(distance(place));
                }
            }
        }
        field
    }

    fn flat(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    fn corner(&self, [x, y, z]: [usize; 3]) -> DVec3 {
        self.low + DVec3::new(x as f64, y as f64, z as f64) * self.cell
    }

    /// The lower corners of all cells.
    fn cells(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [columns, rows, layers] = self.counts.map(|count| count - 1);
        (0..layers)
            .flat_map(move |z| (0..rows).flat_map(move |y| (0..columns).map(move |x| [x, y, z])))
    }

    /// The mean of the points where the cell's edges cross the surface.
    fn vertex(&self, cell: [usize; 3]) -> Option<DVec3> {
        let (mut sum, mut count) = (DVec3::ZERO, 0.0);
        for axis in 0..3 {
            for other in 0..4 {
                let mut start = cell;
                start[(axis + 1) % 3] += other & 1;
                start[(axis + 2) % 3] += other >> 1;
                let mut end = start;
                end[axis] += 1;
                let (a, b) = (self.values[self.flat(start)], self.values[self.flat(end)]);
                if (a < 0.0) != (b < 0.0) {
                    sum += self.corner(start).lerp(self.corner(end), a / (a - b));
                    count += 1.0;
                }
            }
        }
        (count > 0.0).then(|| sum / count)
    }

    /// Joins the four cells around the edge that starts at this corner, if the surface crosses it.
    fn add_quadrilateral(
        &self,
        mesh: &mut TriangleMesh,
        vertex_of_cell: &[u32],
        corner: [usize; 3],
        axis: usize,
    ) {
        let (across, over) = ((axis + 1) % 3, (axis + 2) % 3);
        if corner[across] == 0 || corner[over] == 0 {
            return;
        }
        let mut end = corner;
        end[axis] += 1;
        let is_inside = self.values[self.flat(corner)] < 0.0;
        if is_inside == (self.values[self.flat(end)] < 0.0) {
            return;
        }
        let vertex = |back_across: usize, back_over: usize| {
            let mut cell = corner;
            cell[across] -= back_across;
            cell[over] -= back_over;
            vertex_of_cell[self.flat(cell)]
        };
        let [a, b, c, d] = [vertex(1, 1), vertex(0, 1), vertex(0, 0), vertex(1, 0)];
        if is_inside {
            mesh.indices.extend([[a, b, c], [a, c, d]]);
        } else {
            mesh.indices.extend([[a, c, b], [a, d, c]]);
        }
    }
}

/// The point of the surface near `start`, and its normal.
fn project(distance: impl Fn(DVec3) -> f64, start: DVec3, cell: f64) -> (DVec3, DVec3) {
    let gradient = |place: DVec3| {
        let step = cell * 0.05;
        let along = |axis: DVec3| distance(place + axis * step) - distance(place - axis * step);
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z)) / (2.0 * step)
    };
    let mut place = start;
    for _ in 0..2 {
        let slope = gradient(place);
        let step = slope * (distance(place) / slope.length_squared().max(1e-6));
        place -= step.clamp_length_max(0.5 * cell);
    }
    (place, gradient(place).normalize_or(DVec3::Y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mesh_of_a_ball_is_closed_and_has_its_area() {
        let lattice = Lattice { low: DVec3::splat(-1.2), high: DVec3::splat(1.2), cell: 0.08 };
        let ball = mesh(&lattice, |place| place.length() - 1.0);
        assert!((ball.surface_area() / (4.0 * std::f64::consts::PI) - 1.0).abs() < 5e-3);
        // Euler's formula for a closed surface without holes, in triangles.
        assert_eq!(ball.indices.len(), 2 * ball.positions.len() - 4);
        for [a, b, c] in &ball.indices {
            let [a, b, c] = [a, b, c].map(|index| ball.positions[*index as usize]);
            assert!((b - a).cross(c - a).dot(a) > 0.0, "the front is outside");
        }
    }
}
