//! Splits vertices along sharp edges, so that smooth normals stop there.

use crate::error::{MeshError, MeshErrorKind};
use crate::normals::{unit_normal, unit_or_default};
use crate::triangle_mesh::{AttributeDomain, TriangleMesh};
use glam::Vec3;
use std::collections::HashMap;

/// Where more than two triangles share an edge, each is compared with this many others. Comparing
/// all pairs would take quadratic time on a malicious file.
const COMPARED_AT_EDGE: usize = 8;

impl TriangleMesh {
    /// Replaces the vertex normals by angle-weighted ones that are smooth only across edges where
    /// the normals of the two triangles differ by at most `max_smooth_angle` degrees. Vertices on
    /// sharper edges are split: each side gets its own copy, including attributes. Mitsuba 0.6
    /// calls this `maxSmoothAngle`.
    ///
    /// Triangles share an edge if the positions of both ends are equal, whether or not the indices
    /// are, so seams in the texture coordinates become smooth, too. Degenerate triangles are
    /// ignored. Vertices are renumbered in the order of first use, and unused ones are dropped.
    ///
    /// # Errors
    ///
    /// [`MeshErrorKind::Limit`] if the triangles have more than 2³² − 1 corners; the mesh is then
    /// unchanged.
    ///
    /// # Panics
    ///
    /// If the mesh is not valid.
    pub fn split_sharp_edges(&mut self, max_smooth_angle: f32) -> Result<(), MeshError> {
        let corner_count = self.corner_count()?;
        let groups = self.smooth_groups(corner_count, max_smooth_angle);
        let sums =
            self.angle_weighted_sums(|corner, _| groups[corner] as usize, corner_count as usize);
        self.split_vertices(&groups, &sums);
        Ok(())
    }

    /// Gives every triangle its own three vertices, with the triangle's normal.
    ///
    /// # Errors
    ///
    /// As [`TriangleMesh::split_sharp_edges`].
    ///
    /// # Panics
    ///
    /// If the mesh is not valid.
    pub(crate) fn separate_faces(&mut self) -> Result<(), MeshError> {
        let groups: Vec<u32> = (0..self.corner_count()?).map(|corner| corner / 3).collect();
        let normals: Vec<Vec3> =
            (0..self.indices.len()).map(|face| unit_normal(self.corners(face))).collect();
        self.split_vertices(&groups, &normals);
        Ok(())
    }

    /// The total number of corners, if each can be a vertex.
    fn corner_count(&self) -> Result<u32, MeshError> {
        let triangle_count = self.indices.len();
        triangle_count.checked_mul(3).and_then(|count| u32::try_from(count).ok()).ok_or_else(|| {
            MeshError::new(
                MeshErrorKind::Limit,
                format!("the corners of {triangle_count} triangles exceed the vertex limit"),
            )
        })
    }

    /// For each corner (index: three times the triangle plus 0, 1 or 2), the representative of its
    /// smooth group: the corners at the same position across smooth edges.
    fn smooth_groups(&self, corner_count: u32, max_smooth_angle: f32) -> Vec<u32> {
        let normals: Vec<Vec3> =
            (0..self.indices.len()).map(|face| unit_normal(self.corners(face))).collect();
        let is_smooth = |first: &Edge, second: &Edge| {
            let (first, second) = (normals[first.face()], normals[second.face()]);
            first != Vec3::ZERO
                && second != Vec3::ZERO
                && degrees_between(first, second) <= max_smooth_angle
        };
        let mut groups = Groups { parents: (0..corner_count).collect() };
        for shared in self.sorted_edges().chunk_by(|a, b| a.positions == b.positions) {
            for (number, first) in shared.iter().enumerate() {
                for second in shared[number + 1..].iter().take(COMPARED_AT_EDGE) {
                    if is_smooth(first, second) {
                        groups.join(first.corners[0], second.corners[0]);
                        groups.join(first.corners[1], second.corners[1]);
                    }
                }
            }
        }
        (0..corner_count).map(|corner| groups.root(corner)).collect()
    }

    /// The three edges of every triangle, sorted so that coincident edges are adjacent.
    fn sorted_edges(&self) -> Vec<Edge> {
        let position_ids = self.position_ids();
        let mut edges = Vec::with_capacity(3 * self.indices.len());
        for (face, indices) in self.indices.iter().enumerate() {
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let id = |corner: usize| position_ids[indices[corner] as usize];
                let corner = |corner: usize| (3 * face + corner) as u32;
                let (low, high) = if id(from) <= id(to) { (from, to) } else { (to, from) };
                edges.push(Edge {
                    positions: [id(low), id(high)],
                    corners: [corner(low), corner(high)],
                });
            }
        }
        edges.sort_unstable();
        edges
    }

    /// An id for each vertex; vertices with equal positions have the same id.
    fn position_ids(&self) -> Vec<u32> {
        let mut ids = HashMap::new();
        let id = |(vertex, position): (usize, &Vec3)| {
            // Adding zero turns −0 into +0.
            let key = (*position + Vec3::ZERO).to_array().map(f32::to_bits);
            *ids.entry(key).or_insert(vertex as u32)
        };
        self.positions.iter().enumerate().map(id).collect()
    }

    /// Makes one vertex per pair of an old vertex and a smooth group, with the group's normal.
    fn split_vertices(&mut self, groups: &[u32], sums: &[Vec3]) {
        let mut vertices = HashMap::new();
        let mut origins: Vec<usize> = Vec::new();
        let mut normals = Vec::new();
        for (index, &group) in self.indices.as_flattened_mut().iter_mut().zip(groups) {
            *index = *vertices.entry((*index, group)).or_insert_with(|| {
                origins.push(*index as usize);
                normals.push(unit_or_default(sums[group as usize]));
                (origins.len() - 1) as u32
            });
        }
        self.normals = normals;
        self.positions = origins.iter().map(|&origin| self.positions[origin]).collect();
        if !self.uvs.is_empty() {
            self.uvs = origins.iter().map(|&origin| self.uvs[origin]).collect();
        }
        for attribute in &mut self.attributes {
            if attribute.domain == AttributeDomain::Vertex {
                let channels = attribute.channels as usize;
                let of = |origin: &usize| &attribute.values[origin * channels..][..channels];
                attribute.values = origins.iter().flat_map(of).copied().collect();
            }
        }
    }
}

/// The edge of a triangle. Its ends are ordered by position id, so that coincident edges compare
/// equal.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    positions: [u32; 2],
    corners: [u32; 2],
}

impl Edge {
    fn face(&self) -> usize {
        self.corners[0] as usize / 3
    }
}

/// Disjoint sets of corners (Tarjan, "Efficiency of a Good But Not Linear Set Union Algorithm",
/// 1975), with path halving.
struct Groups {
    parents: Vec<u32>,
}

impl Groups {
    fn root(&mut self, mut corner: u32) -> u32 {
        while self.parents[corner as usize] != corner {
            let grandparent = self.parents[self.parents[corner as usize] as usize];
            self.parents[corner as usize] = grandparent;
            corner = grandparent;
        }
        corner
    }

    fn join(&mut self, first: u32, second: u32) {
        let (first, second) = (self.root(first), self.root(second));
        self.parents[first.max(second) as usize] = first.min(second);
    }
}

/// The angle between unit vectors, by a formula that is accurate for small angles, too.
fn degrees_between(first: Vec3, second: Vec3) -> f32 {
    (2.0 * (first - second).length().atan2((first + second).length())).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangle_mesh::Attribute;
    use glam::Vec2;

    /// Two unit squares that share the edge x = 1, with this angle between their normals.
    fn hinge(degrees: f32) -> TriangleMesh {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let far = Vec3::new(1.0 + cos, 0.0, -sin);
        TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y, far, far + Vec3::Y],
            uvs: (0..6).map(|vertex| Vec2::splat(vertex as f32)).collect(),
            indices: vec![[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]],
            attributes: vec![Attribute {
                name: "vertex_number".into(),
                domain: AttributeDomain::Vertex,
                channels: 2,
                values: (0..12).map(|value| value as f32).collect(),
            }],
            ..TriangleMesh::default()
        }
    }

    #[test]
    fn edges_above_the_angle_are_split() {
        for (max_smooth_angle, vertex_count) in [(44.0, 8), (46.0, 6), (180.0, 6)] {
            let mut mesh = hinge(45.0);
            mesh.split_sharp_edges(max_smooth_angle).expect("small");
            assert_eq!(mesh.validate(), Ok(()));
            assert_eq!(mesh.positions.len(), vertex_count);
            let normal = mesh.normals[mesh.indices[0][1] as usize];
            let half = 22.5_f32.to_radians();
            let expected =
                if vertex_count == 8 { Vec3::Z } else { Vec3::new(half.sin(), 0.0, half.cos()) };
            assert!((normal - expected).length() < 1e-6, "{max_smooth_angle}: {normal}");
        }
    }

    #[test]
    fn split_vertices_keep_their_attributes() {
        let original = hinge(90.0);
        let mut mesh = original.clone();
        mesh.split_sharp_edges(30.0).expect("small");
        for (face, corners) in original.indices.iter().enumerate() {
            for (corner, &old) in corners.iter().enumerate() {
                let (new, old) = (mesh.indices[face][corner] as usize, old as usize);
                assert_eq!(mesh.positions[new], original.positions[old]);
                assert_eq!(mesh.uvs[new], original.uvs[old]);
                let values = |mesh: &TriangleMesh, vertex: usize| {
                    mesh.attributes[0].values[2 * vertex..2 * vertex + 2].to_vec()
                };
                assert_eq!(values(&mesh, new), values(&original, old));
            }
        }
    }

    #[test]
    fn seams_are_smoothed_and_the_sign_of_zero_is_ignored() {
        let mut mesh = hinge(10.0);
        // The second square gets its own copies of the shared vertices.
        mesh.positions.extend([Vec3::new(1.0, -0.0, 0.0), mesh.positions[2]]);
        mesh.uvs.extend([Vec2::ZERO; 2]);
        mesh.attributes.clear();
        mesh.indices[2..].copy_from_slice(&[[6, 4, 5], [6, 5, 7]]);
        mesh.split_sharp_edges(30.0).expect("small");
        assert_eq!(mesh.positions.len(), 8);
        let normal = |face: usize, corner: usize| mesh.normals[mesh.indices[face][corner] as usize];
        assert_eq!(normal(0, 1), normal(2, 0));
        assert!(normal(0, 1).x > 0.0);
    }

    #[test]
    fn a_large_fan_around_one_edge_does_not_take_quadratic_time() {
        let count = 100_000;
        let mut positions = vec![Vec3::ZERO, Vec3::Z];
        positions.extend((0..count).map(|i| Vec3::new((i as f32).cos(), (i as f32).sin(), 0.5)));
        let indices = (0..count).map(|i| [0, 1, i + 2]).collect();
        let mut mesh = TriangleMesh { positions, indices, ..TriangleMesh::default() };
        mesh.split_sharp_edges(20.0).expect("small");
        assert_eq!(mesh.validate(), Ok(()));
    }
}
