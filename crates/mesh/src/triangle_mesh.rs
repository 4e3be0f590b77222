//! The indexed triangle mesh that every reader produces.

use crate::error::{MeshError, MeshErrorKind};
use etendue_math::Bounds3;
use glam::{Vec2, Vec3};

/// An indexed triangle mesh.
///
/// The front of a triangle is the side from which its corners are counter-clockwise. Readers only
/// return meshes that pass [`TriangleMesh::validate`]. The fields are public, so other meshes may
/// not be valid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// The name in the file; empty if there is none.
    pub name: String,
    /// The vertex positions.
    pub positions: Vec<Vec3>,
    /// One shading normal per vertex, or none at all. Readers keep the length that the file gives,
    /// which need not be one.
    pub normals: Vec<Vec3>,
    /// One texture coordinate per vertex, or none at all.
    pub uvs: Vec<Vec2>,
    /// The three corners of each triangle, as indices into `positions`.
    pub indices: Vec<[u32; 3]>,
    /// Additional values on vertices or faces.
    pub attributes: Vec<Attribute>,
}

/// A named set of values on the vertices or faces of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// The name, with its domain as prefix: `vertex_color`, `face_weight`.
    pub name: String,
    /// Whether the values belong to vertices or faces.
    pub domain: AttributeDomain,
    /// The number of values per vertex or face; at least one.
    pub channels: u32,
    /// The values: all channels of the first vertex or face, then of the second, and so on.
    pub values: Vec<f32>,
}

/// The elements that the values of an [`Attribute`] belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AttributeDomain {
    /// One value per vertex, to be interpolated.
    Vertex,
    /// One value per triangle.
    Face,
}

impl AttributeDomain {
    /// The prefix of the names of all attributes in this domain.
    #[must_use]
    pub fn prefix(self) -> &'static str {
        match self {
            Self::Vertex => "vertex_",
            Self::Face => "face_",
        }
    }
}

/// How much was not finite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Replaced {
    pub(crate) normals: usize,
    pub(crate) uvs: usize,
    pub(crate) values: usize,
}

impl TriangleMesh {
    /// The box around all vertices, including unused ones.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        Bounds3::from_points(self.positions.iter().copied())
    }

    /// The positions of the corners of triangle `face`.
    ///
    /// # Panics
    ///
    /// If `face` is out of range or the mesh is not valid.
    #[must_use]
    pub fn corners(&self, face: usize) -> [Vec3; 3] {
        self.indices[face].map(|index| self.positions[index as usize])
    }

    /// The total area of all triangles, in squared units of the positions. Summed in double
    /// precision, so that small triangles are not lost.
    ///
    /// # Panics
    ///
    /// If the mesh is not valid.
    #[must_use]
    pub fn surface_area(&self) -> f64 {
        let area = |face: usize| {
            let [a, b, c] = self.corners(face).map(Vec3::as_dvec3);
            0.5 * (b - a).cross(c - a).length()
        };
        (0..self.indices.len()).map(area).sum()
    }

    /// Checks the invariants that all consumers rely on.
    ///
    /// # Errors
    ///
    /// [`MeshErrorKind::OutOfRange`] for an index without a vertex, [`MeshErrorKind::NonFinite`]
    /// for a number that is NaN or infinite, [`MeshErrorKind::Inconsistent`] if the number of
    /// normals, texture coordinates or attribute values does not match that of the vertices or
    /// faces, and [`MeshErrorKind::Limit`] for more than 2³² − 2 vertices.
    pub fn validate(&self) -> Result<(), MeshError> {
        self.validate_lengths()?;
        self.validate_indices()?;
        self.validate_numbers()
    }

    /// Replaces normals, texture coordinates and attribute values that are not finite by zero;
    /// returns how many of each there were.
    pub(crate) fn replace_non_finite(&mut self) -> Replaced {
        let mut replaced = Replaced::default();
        for normal in self.normals.iter_mut().filter(|normal| !normal.is_finite()) {
            *normal = Vec3::ZERO;
            replaced.normals += 1;
        }
        for uv in self.uvs.iter_mut().filter(|uv| !uv.is_finite()) {
            *uv = Vec2::ZERO;
            replaced.uvs += 1;
        }
        let values = self.attributes.iter_mut().flat_map(|attribute| &mut attribute.values);
        for value in values.filter(|value| !value.is_finite()) {
            *value = 0.0;
            replaced.values += 1;
        }
        replaced
    }

    fn validate_lengths(&self) -> Result<(), MeshError> {
        let vertex_count = self.positions.len();
        check_vertex_count(vertex_count as u64)?;
        for (what, count) in [("normals", self.normals.len()), ("uvs", self.uvs.len())] {
            if count != 0 && count != vertex_count {
                return Err(MeshError::new(
                    MeshErrorKind::Inconsistent,
                    format!("the mesh has {vertex_count} vertices but {count} {what}"),
                ));
            }
        }
        for attribute in &self.attributes {
            let carriers = match attribute.domain {
                AttributeDomain::Vertex => vertex_count,
                AttributeDomain::Face => self.indices.len(),
            };
            let expected = carriers.checked_mul(attribute.channels as usize);
            if attribute.channels == 0 || expected != Some(attribute.values.len()) {
                return Err(MeshError::new(
                    MeshErrorKind::Inconsistent,
                    format!(
                        "attribute `{}` has {} values, but {carriers} × {} are needed",
                        attribute.name,
                        attribute.values.len(),
                        attribute.channels
                    ),
                ));
            }
        }
        Ok(())
    }

    fn validate_indices(&self) -> Result<(), MeshError> {
        let vertex_count = self.positions.len();
        let is_bad = |corners: &[u32; 3]| corners.iter().any(|&i| i as usize >= vertex_count);
        match self.indices.iter().position(is_bad) {
            None => Ok(()),
            Some(face) => Err(MeshError::new(
                MeshErrorKind::OutOfRange,
                format!(
                    "triangle {face} has the corners {:?}, but there are {vertex_count} vertices",
                    self.indices[face]
                ),
            )),
        }
    }

    fn validate_numbers(&self) -> Result<(), MeshError> {
        let first_bad = |vectors: &[Vec3]| vectors.iter().position(|vector| !vector.is_finite());
        let bad = |what: &str, place: usize| {
            Err(MeshError::new(
                MeshErrorKind::NonFinite,
                format!("vertex {place} has a {what} that is not finite"),
            ))
        };
        if let Some(vertex) = first_bad(&self.positions) {
            return bad("position", vertex);
        }
        if let Some(vertex) = first_bad(&self.normals) {
            return bad("normal", vertex);
        }
        if let Some(vertex) = self.uvs.iter().position(|uv| !uv.is_finite()) {
            return bad("texture coordinate", vertex);
        }
        for attribute in &self.attributes {
            if let Some(place) = attribute.values.iter().position(|value| !value.is_finite()) {
                return Err(MeshError::new(
                    MeshErrorKind::NonFinite,
                    format!("value {place} of attribute `{}` is not finite", attribute.name),
                ));
            }
        }
        Ok(())
    }
}

/// Rejects vertex counts that do not fit `u32` indices; the greatest index is reserved for "none".
pub(crate) fn check_vertex_count(count: u64) -> Result<(), MeshError> {
    if count < u64::from(u32::MAX) {
        return Ok(());
    }
    Err(MeshError::new(
        MeshErrorKind::Limit,
        format!("{count} vertices exceed the limit of {}", u32::MAX - 1),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn right_triangle() -> TriangleMesh {
        TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X * 3.0, Vec3::Y * 4.0],
            indices: vec![[0, 1, 2]],
            ..TriangleMesh::default()
        }
    }

    fn kind(mesh: &TriangleMesh) -> Option<MeshErrorKind> {
        mesh.validate().err().map(|error| error.kind)
    }

    #[test]
    fn area_and_bounds_of_a_right_triangle() {
        let mesh = right_triangle();
        assert_eq!(mesh.surface_area(), 6.0);
        assert_eq!(mesh.bounds(), Bounds3::new(Vec3::ZERO, Vec3::new(3.0, 4.0, 0.0)));
        assert!(TriangleMesh::default().bounds().is_empty());
    }

    #[test]
    fn validation_reports_each_defect() {
        assert_eq!(kind(&right_triangle()), None);
        let mut mesh = right_triangle();
        mesh.indices[0][1] = 3;
        assert_eq!(kind(&mesh), Some(MeshErrorKind::OutOfRange));
        let mut mesh = right_triangle();
        mesh.positions[2].y = f32::NAN;
        assert_eq!(kind(&mesh), Some(MeshErrorKind::NonFinite));
        let mut mesh = right_triangle();
        mesh.uvs = vec![Vec2::ZERO; 2];
        assert_eq!(kind(&mesh), Some(MeshErrorKind::Inconsistent));
        let mut mesh = right_triangle();
        mesh.uvs = vec![Vec2::splat(f32::INFINITY); 3];
        assert_eq!(kind(&mesh), Some(MeshErrorKind::NonFinite));
        let mut mesh = right_triangle();
        mesh.normals = vec![Vec3::NAN; 3];
        assert_eq!(kind(&mesh), Some(MeshErrorKind::NonFinite));
        assert_eq!(
            check_vertex_count(1 << 32).map_err(|error| error.kind),
            Err(MeshErrorKind::Limit)
        );
    }

    #[test]
    fn attributes_must_fit_their_domain() {
        let attribute = |domain, channels, count| Attribute {
            name: "face_weight".into(),
            domain,
            channels,
            values: vec![0.5; count],
        };
        let with = |attribute| TriangleMesh { attributes: vec![attribute], ..right_triangle() };
        assert_eq!(kind(&with(attribute(AttributeDomain::Face, 2, 2))), None);
        assert_eq!(kind(&with(attribute(AttributeDomain::Vertex, 1, 3))), None);
        for bad in [
            attribute(AttributeDomain::Face, 0, 0),
            attribute(AttributeDomain::Face, 3, 2),
            attribute(AttributeDomain::Vertex, 1, 1),
        ] {
            assert_eq!(kind(&with(bad)), Some(MeshErrorKind::Inconsistent));
        }
    }
}
