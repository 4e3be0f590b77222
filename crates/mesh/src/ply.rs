//! PLY, the Stanford polygon format (Turk, "The PLY Polygon File Format", 1994).

mod attributes;
mod faces;
mod header;
mod scalar;
mod source;
mod vertices;
mod write;

pub use write::write_ply;

use crate::error::{MeshError, MeshErrorKind};
use crate::text::TextCursor;
use crate::triangle_mesh::{TriangleMesh, check_vertex_count};
use faces::read_faces;
use header::{Element, Encoding, Header};
use source::{AsciiSource, BinarySource, Source};
use std::fmt;
use vertices::read_vertices;

/// Reads a PLY file in any of its three encodings.
///
/// - Properties may have any order and type. `x y z` are required; `nx ny nz` are the normals;
///   `u v`, `s t` or `texture_u texture_v` the texture coordinates.
/// - The list `vertex_indices` or `vertex_index` holds the corners of faces. Polygons are split as
///   a fan, concave ones by ear clipping (if the vertices come before the faces). Faces with fewer
///   than three corners are ignored.
/// - All other numbers of vertices and faces become an [`Attribute`](crate::Attribute), named by
///   Mitsuba 3's rules: consecutive properties `foo_0 foo_1 …` or `foo_x foo_y …` are the channels
///   of `vertex_foo` (`face_foo` on faces), and `r g b` or `red green blue` (with `a`, `alpha`)
///   those of `vertex_color`. A property outside of these groups is an attribute of its own with
///   one channel. Colours in 8 or 16 unsigned bits are scaled to [0, 1]; Mitsuba warns and uses
///   them unscaled. The values of a polygon apply to all its triangles.
/// - A file without faces is a mesh without triangles. Normals, texture coordinates and attributes
///   that are not finite are replaced.
/// - Other lists and elements are skipped. The file may end after the vertices and faces.
///
/// # Errors
///
/// [`MeshErrorKind::Syntax`] for a malformed header or number,
/// [`Truncated`](MeshErrorKind::Truncated) if the header announces more data than there is,
/// [`OutOfRange`](MeshErrorKind::OutOfRange) for an index without a vertex,
/// [`NonFinite`](MeshErrorKind::NonFinite) for a position that is not finite in single precision,
/// [`Unsupported`](MeshErrorKind::Unsupported) for a file without positions or with triangle strips,
/// and [`Limit`](MeshErrorKind::Limit) for more than 2³² − 2 vertices.
pub fn read_ply(bytes: &[u8]) -> Result<PlyMesh, MeshError> {
    let mut cursor = TextCursor::new(bytes);
    let header = Header::read(&mut cursor)?;
    let has_faces = header.elements.iter().any(Element::is_faces);
    if !has_faces && header.elements.iter().any(|element| element.name == "tristrips") {
        return Err(MeshError::new(
            MeshErrorKind::Unsupported,
            "the file has triangle strips, which are not supported, and no element `face`",
        ));
    }
    let (mesh, replaced) = read_body(bytes, cursor, &header)?;
    let no_faces = (!has_faces).then_some(PlyWarning::NoFaces);
    Ok(PlyMesh { mesh, warnings: no_faces.into_iter().chain(replaced).collect() })
}

/// What [`read_ply`] returns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyMesh {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// What was ignored or replaced.
    pub warnings: Vec<PlyWarning>,
}

/// Something in a PLY file that was ignored or replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlyWarning {
    /// The file is a point cloud: the mesh has no triangles.
    NoFaces,
    /// So many normals were not finite, and were replaced by computed ones.
    UnusableNormals(usize),
    /// So many texture coordinates were not finite, and were replaced by (0, 0).
    UnusableUvs(usize),
    /// So many values of attributes were not finite, and were replaced by zero.
    UnusableValues(usize),
}

impl fmt::Display for PlyWarning {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFaces => formatter.write_str("the file has no faces: it is a point cloud"),
            Self::UnusableNormals(count) => {
                write!(formatter, "{count} normals that are not finite were replaced")
            }
            Self::UnusableUvs(count) => {
                write!(formatter, "{count} texture coordinates that are not finite are (0, 0)")
            }
            Self::UnusableValues(count) => {
                write!(formatter, "{count} values of attributes that are not finite are 0")
            }
        }
    }
}

/// Reads only the vertices of a PLY file, as [`read_ply`] does: a point cloud with attributes.
/// Faces are optional and ignored.
///
/// # Errors
///
/// As [`read_ply`], [`MeshErrorKind::Unsupported`] for a file without vertices, and
/// [`MeshErrorKind::NonFinite`] for an attribute that is not finite, as it may decide where a point is.
pub fn read_ply_points(bytes: &[u8]) -> Result<TriangleMesh, MeshError> {
    let mut cursor = TextCursor::new(bytes);
    let mut header = Header::read(&mut cursor)?;
    let Some(vertices) = header.elements.iter().position(Element::is_vertices) else {
        return Err(MeshError::new(
            MeshErrorKind::Unsupported,
            "the file has no element `vertex`, so it has no points",
        ));
    };
    header.elements.truncate(vertices + 1);
    // Faces before the vertices are skipped like any other element.
    for element in &mut header.elements[..vertices] {
        element.name.clear();
    }
    let (points, warnings) = read_body(bytes, cursor, &header)?;
    let broken = |warning: &&PlyWarning| matches!(warning, PlyWarning::UnusableValues(_));
    if let Some(PlyWarning::UnusableValues(count)) = warnings.iter().find(broken) {
        let message = format!("{count} values of attributes are not finite");
        return Err(MeshError::new(MeshErrorKind::NonFinite, message));
    }
    Ok(points)
}

/// Reads the data after the header. Also returns what was replaced.
fn read_body(
    bytes: &[u8],
    cursor: TextCursor<'_>,
    header: &Header,
) -> Result<(TriangleMesh, Vec<PlyWarning>), MeshError> {
    check_vertex_count(header.vertex_count())?;
    let mut mesh = match header.encoding {
        Encoding::Ascii => read_elements(header, AsciiSource::new(cursor))?,
        Encoding::Binary(order) => {
            let body = cursor.rest();
            read_elements(header, BinarySource::new(body, bytes.len() - body.len(), order))?
        }
    };
    mesh.indices.shrink_to_fit();
    let replaced = mesh.replace_non_finite();
    mesh.validate()?;
    if replaced.normals > 0 {
        mesh.fill_missing_normals();
    }
    let warnings = [
        (replaced.normals > 0).then_some(PlyWarning::UnusableNormals(replaced.normals)),
        (replaced.uvs > 0).then_some(PlyWarning::UnusableUvs(replaced.uvs)),
        (replaced.values > 0).then_some(PlyWarning::UnusableValues(replaced.values)),
    ];
    Ok((mesh, warnings.into_iter().flatten().collect()))
}

fn read_elements(header: &Header, mut source: impl Source) -> Result<TriangleMesh, MeshError> {
    let mut mesh = TriangleMesh::default();
    let (mut vertices_pending, mut faces_pending) = (true, true);
    for element in &header.elements {
        if !vertices_pending && !faces_pending {
            break;
        }
        source.check_room(element)?;
        if vertices_pending && element.is_vertices() {
            read_vertices(element, &mut source, &mut mesh)?;
            vertices_pending = false;
        } else if faces_pending && element.is_faces() {
            read_faces(element, &mut source, header.vertex_count(), &mut mesh)?;
            faces_pending = false;
        } else {
            source.skip(element)?;
        }
    }
    Ok(mesh)
}
