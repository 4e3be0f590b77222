//! `rectangle`: two triangles that share a diagonal.

use crate::builder::Assets;
use crate::manual::{Manual, parameter};
use crate::models::mesh::{Mesh, MeshOptions};
use etendue_document::Parameters;
use etendue_math::Transform;
use etendue_mesh::TriangleMesh;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The square from (−1, −1, 0) to (1, 1, 0), facing +z, placed by `to_world`.",
    parameters: &[
        parameter("flip_normals", "boolean", "false", "Let the normal point the other way."),
        parameter("to_world", "transform", "", "Placement."),
    ],
    sample: r#"<shape type="rectangle"><transform name="to_world"><scale value="3"/></transform></shape>"#,
};

/// Reads a rectangle.
#[must_use]
pub fn build(_assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Mesh> {
    let flip_normals = parameters.boolean("flip_normals", false);
    let to_world = crate::inputs::transform::read_transform(parameters, "to_world")?;
    placed(to_world, flip_normals)
}

fn placed(to_world: Transform, flip_normals: bool) -> Option<Mesh> {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let mesh = TriangleMesh {
        name: "rectangle".to_owned(),
        positions: corners.map(|(u, v)| Vec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.0)).to_vec(),
        normals: vec![Vec3::Z; 4],
        uvs: corners.map(|(u, v)| Vec2::new(u, v)).to_vec(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..TriangleMesh::default()
    };
    Mesh::new(mesh, &MeshOptions::placement(to_world, flip_normals)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat4, DVec3};

    #[test]
    fn it_faces_up_also_when_mirrored_and_down_when_flipped() {
        for (scale, flip, expected) in [
            (DVec3::ONE, false, Vec3::Z),
            (DVec3::new(-2.0, 1.0, 1.0), false, Vec3::Z),
            (DVec3::ONE, true, -Vec3::Z),
        ] {
            let to_world = Transform::from_matrix(&DMat4::from_scale(scale)).expect("invertible");
            let mesh = placed(to_world, flip).expect("two triangles");
            let surface = mesh.surface_point(0, Vec2::new(0.2, 0.3));
            assert_eq!(surface.normal, expected, "{scale} {flip}");
        }
    }

    #[test]
    fn samples_cover_it_with_matching_coordinates() {
        let mut mesh = placed(Transform::IDENTITY, false).expect("two triangles");
        mesh.prepare_sampling();
        for (x, y) in [(0.0, 0.0), (0.9, 0.1), (0.1, 0.9), (0.5, 0.5), (0.999, 0.999)] {
            let sample = mesh.sample_area(Vec2::new(x, y)).expect("it has an area");
            assert!((sample.uv - Vec2::new(x, y)).abs().max_element() < 1e-6, "{sample:?}");
            assert!((sample.point.truncate() - (sample.uv * 2.0 - 1.0)).length() < 1e-6);
            assert!((sample.pdf - 0.25).abs() < 1e-7);
        }
    }
}
