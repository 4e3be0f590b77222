//! `cube`: twelve triangles.

use crate::builder::Assets;
use crate::manual::{Manual, parameter};
use crate::models::mesh::{Mesh, MeshOptions};
use etendue_document::Parameters;
use etendue_mesh::TriangleMesh;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The cube from (−1, −1, −1) to (1, 1, 1), placed by `to_world`. Every face has its own \
              coordinates from (0, 0) to (1, 1).",
    parameters: &[
        parameter("flip_normals", "boolean", "false", "Let the normals point inwards."),
        parameter("to_world", "transform", "", "Placement."),
    ],
    sample: r#"<shape type="cube"><transform name="to_world"><rotate y="1" angle="30"/></transform></shape>"#,
};

/// Reads a cube.
#[must_use]
pub fn build(_assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Mesh> {
    let flip_normals = parameters.boolean("flip_normals", false);
    let to_world = crate::inputs::transform::read_transform(parameters, "to_world")?;
    Mesh::new(unit_cube(), &MeshOptions::placement(to_world, flip_normals)).ok()
}

/// The directions of u, v and the outward normal of each face, in Mitsuba's triangle order.
const FACES: [[Vec3; 3]; 6] = [
    [Vec3::Z, Vec3::X, Vec3::NEG_Y],
    [Vec3::NEG_X, Vec3::NEG_Z, Vec3::Y],
    [Vec3::Y, Vec3::NEG_Z, Vec3::X],
    [Vec3::Y, Vec3::X, Vec3::Z],
    [Vec3::Y, Vec3::Z, Vec3::NEG_X],
    [Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z],
];

/// The cube in local space.
pub(super) fn unit_cube() -> TriangleMesh {
    let mut mesh = TriangleMesh { name: "cube".to_owned(), ..TriangleMesh::default() };
    for (face, [u_axis, v_axis, normal]) in (0_u32..).zip(FACES) {
        let right_handed = u_axis.cross(v_axis).dot(normal) > 0.0;
        for (u, v) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            mesh.positions.push(normal + u_axis * (2.0 * u - 1.0) + v_axis * (2.0 * v - 1.0));
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::new(u, v));
        }
        let first = 4 * face;
        for triangle in [[0, 1, 2], [0, 2, 3]] {
            let [a, b, c] = triangle.map(|corner| first + corner);
            mesh.indices.push(if right_handed { [a, b, c] } else { [a, c, b] });
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_face_looks_outwards_and_the_area_is_that_of_six_squares() {
        let options = MeshOptions::placement(etendue_math::Transform::IDENTITY, false);
        let mesh = Mesh::new(unit_cube(), &options).expect("twelve triangles");
        assert!((mesh.area() - 24.0).abs() < 1e-5);
        for triangle in 0..12 {
            let surface = mesh.surface_point(triangle, Vec2::new(0.3, 0.3));
            assert!(surface.normal.dot(surface.point) > 0.99, "{triangle}: {surface:?}");
            assert!(surface.normal.dot(surface.shading_normal) > 0.99, "{triangle}: {surface:?}");
        }
    }

    /// Taken from Mitsuba 3.9.1: the corner of each face where u is 0 and v is 1.
    #[test]
    fn coordinates_are_those_of_mitsuba() {
        let expected = [
            [1.0, -1.0, -1.0],
            [1.0, 1.0, -1.0],
            [1.0, -1.0, -1.0],
            [1.0, -1.0, 1.0],
            [-1.0, -1.0, 1.0],
            [1.0, 1.0, -1.0],
        ];
        let mesh = unit_cube();
        let corners = mesh.positions.iter().zip(&mesh.uvs).filter(|(_, uv)| **uv == Vec2::Y);
        let found: Vec<[f32; 3]> = corners.map(|(position, _)| position.to_array()).collect();
        assert_eq!(found, expected);
    }
}
