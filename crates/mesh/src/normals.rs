//! Shading normals: drops, flips and computes them.

use crate::triangle_mesh::TriangleMesh;
use glam::{Vec3, Vec4};

/// The normal of a vertex without a triangle of positive area. Any unit vector would do, because no
/// ray can hit such a vertex; Mitsuba 3 uses the same one.
const DEFAULT_NORMAL: Vec3 = Vec3::X;

/// A sum of vectors is rounding noise if it is shorter than this fraction of the sum of their
/// lengths.
const CANCELLED: f32 = 1e-6;

impl TriangleMesh {
    /// Turns the mesh inside out: reverses the winding of all triangles and the vertex normals.
    pub fn flip_normals(&mut self) {
        for corners in &mut self.indices {
            corners.swap(1, 2);
        }
        for normal in &mut self.normals {
            *normal = -*normal;
        }
    }

    /// Drops the vertex normals, so that the mesh is shaded flat.
    pub fn face_normals(&mut self) {
        self.normals = Vec::new();
    }

    /// Replaces the vertex normals by the normalised mean of the normals of the adjacent triangles,
    /// weighted by their angles at the vertex (Thürmer and Wüthrich, "Computing Vertex Normals from
    /// Polygonal Facets", *Journal of Graphics Tools* 3(1), 1998). Vertices that share a position
    /// but not an index are not averaged: a seam in the texture coordinates stays visible, as in
    /// Mitsuba 3.
    ///
    /// # Panics
    ///
    /// If the mesh is not valid.
    pub fn compute_vertex_normals(&mut self) {
        let sums = self.angle_weighted_sums(|_, vertex| vertex, self.positions.len());
        self.normals = sums.into_iter().map(unit_or_default).collect();
    }

    /// Replaces zero vertex normals by the angle-weighted normals of
    /// [`TriangleMesh::compute_vertex_normals`], and returns their number. Does nothing to a mesh
    /// without normals.
    ///
    /// # Panics
    ///
    /// If the mesh is not valid.
    pub(crate) fn fill_missing_normals(&mut self) -> usize {
        let missing = self.normals.iter().filter(|&&normal| normal == Vec3::ZERO).count();
        if missing > 0 {
            let sums = self.angle_weighted_sums(|_, vertex| vertex, self.positions.len());
            for (normal, sum) in self.normals.iter_mut().zip(sums) {
                if *normal == Vec3::ZERO {
                    *normal = unit_or_default(sum);
                }
            }
        }
        missing
    }

    /// For each of `group_count` groups of corners, the sum of the unit normals of its triangles,
    /// weighted by the angles at the corners. `group` maps a corner (three times the triangle plus
    /// 0, 1 or 2) and its vertex to the group. If triangles lie back to back and their normals
    /// cancel, the result is the normal of one of them.
    pub(crate) fn angle_weighted_sums(
        &self,
        group: impl Fn(usize, usize) -> usize,
        group_count: usize,
    ) -> Vec<Vec3> {
        // The fourth component sums the angles.
        let mut sums = vec![Vec4::ZERO; group_count];
        let mut last_normals = Vec::new();
        let is_cancelled = |sum: &Vec4| sum.truncate().length() < CANCELLED * sum.w;
        self.for_each_corner(|corner, vertex, normal, angle| {
            sums[group(corner, vertex)] += normal.extend(1.0) * angle;
        });
        if sums.iter().any(is_cancelled) {
            last_normals.resize(group_count, Vec3::ZERO);
            self.for_each_corner(|corner, vertex, normal, _| {
                last_normals[group(corner, vertex)] = normal;
            });
        }
        let direction = |(index, sum): (usize, &Vec4)| {
            if is_cancelled(sum) { last_normals[index] } else { sum.truncate() }
        };
        sums.iter().enumerate().map(direction).collect()
    }

    /// Calls `visit` with the index, the vertex, the unit normal and the angle in radians of every
    /// corner, except those of degenerate triangles.
    fn for_each_corner(&self, mut visit: impl FnMut(usize, usize, Vec3, f32)) {
        for (face, indices) in self.indices.iter().enumerate() {
            let corners = self.corners(face);
            let normal = unit_normal(corners);
            if normal == Vec3::ZERO {
                continue;
            }
            for (corner, &vertex) in indices.iter().enumerate() {
                visit(3 * face + corner, vertex as usize, normal, angle_at(corners, corner));
            }
        }
    }
}

/// The unit normal of a triangle, on the side from which it is counter-clockwise; zero if it is
/// degenerate. In double precision: for a triangle of a micrometre, in metres, the cross product
/// would vanish in single precision.
pub(crate) fn unit_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

/// The normalised `sum`, or the default normal if that is not possible.
pub(crate) fn unit_or_default(sum: Vec3) -> Vec3 {
    sum.try_normalize().unwrap_or(DEFAULT_NORMAL)
}

/// The angle in radians between the edges at one corner, by Kahan's formula
/// 2·atan2(|u − v|, |u + v|) for unit u and v. It is accurate for very thin triangles, where the
/// arc cosine of the dot product is not (Kahan, "How Futile are Mindless Assessments of Roundoff in
/// Floating-Point Computation?", section 12).
fn angle_at(corners: [Vec3; 3], corner: usize) -> f32 {
    let towards = |other: usize| (corners[other % 3] - corners[corner]).normalize_or_zero();
    let (to_next, to_previous) = (towards(corner + 1), towards(corner + 2));
    2.0 * (to_next - to_previous).length().atan2((to_next + to_previous).length())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three faces of a cube that meet at the origin. One is split in two triangles, so that
    /// weighting by count or by area would be biased towards it.
    fn cube_corner() -> TriangleMesh {
        TriangleMesh {
            positions: vec![
                Vec3::ZERO,
                Vec3::X,
                Vec3::Y,
                Vec3::Z,
                Vec3::new(7.0, 7.0, 0.0),
                Vec3::splat(9.0),
            ],
            indices: vec![[0, 1, 4], [0, 4, 2], [0, 2, 3], [0, 3, 1]],
            ..TriangleMesh::default()
        }
    }

    #[test]
    fn angle_weights_do_not_depend_on_how_a_face_is_split() {
        let mut mesh = cube_corner();
        mesh.compute_vertex_normals();
        let expected = Vec3::ONE.normalize();
        assert!((mesh.normals[0] - expected).length() < 1e-6, "{}", mesh.normals[0]);
        assert!((mesh.normals[4] - Vec3::Z).length() < 1e-6);
        assert_eq!(mesh.normals[5], DEFAULT_NORMAL);
        assert!(mesh.normals.iter().all(|normal| normal.is_normalized()));
    }

    #[test]
    fn flipping_reverses_the_computed_normals() {
        let mut mesh = cube_corner();
        mesh.compute_vertex_normals();
        let mut flipped = mesh.clone();
        flipped.flip_normals();
        assert_eq!(flipped.normals[0], -mesh.normals[0]);
        let computed_before = flipped.normals[0];
        flipped.compute_vertex_normals();
        assert!((flipped.normals[0] - computed_before).length() < 1e-6);
        flipped.face_normals();
        assert!(flipped.normals.is_empty());
    }

    #[test]
    fn only_zero_normals_are_filled() {
        let mut mesh = cube_corner();
        assert_eq!(mesh.fill_missing_normals(), 0);
        assert!(mesh.normals.is_empty());
        mesh.normals = vec![Vec3::NEG_X; 6];
        mesh.normals[4] = Vec3::ZERO;
        assert_eq!(mesh.fill_missing_normals(), 1);
        assert!((mesh.normals[4] - Vec3::Z).length() < 1e-6);
        assert_eq!(mesh.normals[0], Vec3::NEG_X);
    }

    #[test]
    fn back_to_back_triangles_have_the_normal_of_one_of_them() {
        let mut mesh = cube_corner();
        mesh.positions[1] = Vec3::new(0.3, -0.7, 0.2);
        mesh.indices = vec![[0, 1, 3], [0, 3, 1]];
        mesh.compute_vertex_normals();
        let expected = unit_normal(mesh.corners(1));
        assert_eq!([mesh.normals[0], mesh.normals[1], mesh.normals[3]], [expected; 3]);
    }

    #[test]
    fn tiny_and_needle_triangles_have_normals() {
        let tiny = [Vec3::ZERO, Vec3::X * 1e-21, Vec3::Y * 1e-21];
        assert_eq!(unit_normal(tiny), Vec3::Z);
        let needle = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1e-6, 0.0)];
        assert!((angle_at(needle, 0) - 1e-6).abs() < 1e-11);
        assert_eq!(unit_normal([Vec3::ONE; 3]), Vec3::ZERO);
    }
}
