//! Mitsuba's serialized format, versions 3 and 4 (*Mitsuba 0.6 documentation*, section 8.2.5).
//!
//! A file is a sequence of shapes followed by a dictionary. Each shape starts with a 16-bit
//! identifier and a 16-bit version, followed by a zlib stream: flags, a name (version 4 only), the
//! numbers of vertices and triangles, and then one array after another. All numbers are
//! little-endian.

mod dictionary;
mod inflater;

use crate::error::MeshError;
use crate::triangle_mesh::{Attribute, AttributeDomain, TriangleMesh, check_vertex_count};
use dictionary::{Dictionary, Version};
use glam::{DVec2, DVec3, Vec2, Vec3};
use inflater::Inflater;

/// The flags at the start of a shape.
mod flag {
    /// The shape has vertex normals.
    pub(super) const NORMALS: u32 = 0x0001;
    /// The shape has texture coordinates.
    pub(super) const UVS: u32 = 0x0002;
    /// The shape has vertex colours.
    pub(super) const COLORS: u32 = 0x0008;
    /// The shape is shaded flat.
    pub(super) const FACE_NORMALS: u32 = 0x0010;
    /// Coordinates are in double precision.
    pub(super) const DOUBLE_PRECISION: u32 = 0x2000;
}

/// The number of shapes in a serialized file.
///
/// # Errors
///
/// As [`read_serialized`], for the start and the dictionary of the file.
pub fn serialized_shape_count(bytes: &[u8]) -> Result<u32, MeshError> {
    Dictionary::read(bytes).map(|dictionary| dictionary.shape_count())
}

/// Whether a serialized file has the list of its shapes at its end. Without it, only the first shape
/// can be read.
///
/// # Errors
///
/// As [`read_serialized`], for the start of the file.
pub fn has_shape_list(bytes: &[u8]) -> Result<bool, MeshError> {
    Dictionary::read(bytes).map(|dictionary| dictionary.is_found())
}

/// Reads one shape of a serialized file; the first has index 0.
///
/// Vertex colours become the attribute `vertex_color` with three channels. A flat-shaded shape gets
/// separate vertices for each triangle, with the triangle's normal, to tell it from a shape that
/// lacks normals.
///
/// # Errors
///
/// [`MeshErrorKind::Syntax`](crate::MeshErrorKind::Syntax) if the file or the compressed data is
/// corrupt, [`Unsupported`](crate::MeshErrorKind::Unsupported) for another version,
/// [`OutOfRange`](crate::MeshErrorKind::OutOfRange) for a shape or vertex that does not exist,
/// [`Truncated`](crate::MeshErrorKind::Truncated) if the file or the shape ends early,
/// [`NonFinite`](crate::MeshErrorKind::NonFinite) for a number that is not finite in single
/// precision, and [`Limit`](crate::MeshErrorKind::Limit) for more than 2³² − 2 vertices.
pub fn read_serialized(bytes: &[u8], shape_index: u32) -> Result<TriangleMesh, MeshError> {
    let shape = Dictionary::read(bytes)?.shape(shape_index)?;
    let mut inflater = Inflater::new(shape.compressed, shape.offset);
    let flags = inflater.u32()?;
    let name = match shape.version {
        Version::Three => String::new(),
        Version::Four => inflater.name()?,
    };
    let counts = Counts { vertices: inflater.u64()?, triangles: inflater.u64()? };
    check_vertex_count(counts.vertices)?;
    inflater.check_room(counts.inflated_size(flags))?;
    let mut mesh = read_arrays(&mut inflater, flags, counts)?;
    inflater.check_sum()?;
    mesh.name = name;
    mesh.validate()?;
    if flags & flag::FACE_NORMALS != 0 {
        mesh.separate_faces()?;
    }
    Ok(mesh)
}

/// The counts that the file announces.
#[derive(Clone, Copy)]
struct Counts {
    vertices: u64,
    triangles: u64,
}

impl Counts {
    /// The size of all arrays in bytes.
    fn inflated_size(self, flags: u32) -> u128 {
        let has = |bit: u32| u128::from(flags & bit != 0);
        let numbers = 3 + 3 * has(flag::NORMALS) + 2 * has(flag::UVS) + 3 * has(flag::COLORS);
        let number_size = 4 + 4 * has(flag::DOUBLE_PRECISION);
        u128::from(self.vertices) * numbers * number_size + u128::from(self.triangles) * 12
    }
}

fn read_arrays(
    inflater: &mut Inflater<'_>,
    flags: u32,
    counts: Counts,
) -> Result<TriangleMesh, MeshError> {
    let has = |bit: u32| flags & bit != 0;
    let is_double = has(flag::DOUBLE_PRECISION);
    let positions = read_vectors(inflater, counts.vertices, is_double)?;
    let mut mesh = TriangleMesh { positions, ..TriangleMesh::default() };
    if has(flag::NORMALS) {
        mesh.normals = read_vectors(inflater, counts.vertices, is_double)?;
    }
    if has(flag::UVS) {
        mesh.uvs = if is_double {
            let uv = |row: [[u8; 8]; 2]| DVec2::from_array(row.map(f64::from_le_bytes)).as_vec2();
            inflater.array(counts.vertices, uv)?
        } else {
            let uv = |row: [[u8; 4]; 2]| Vec2::from_array(row.map(f32::from_le_bytes));
            inflater.array(counts.vertices, uv)?
        };
    }
    if has(flag::COLORS) {
        let colors = read_vectors(inflater, counts.vertices, is_double)?;
        mesh.attributes.push(Attribute {
            name: "vertex_color".to_owned(),
            domain: AttributeDomain::Vertex,
            channels: 3,
            values: colors.into_iter().flat_map(|color| color.to_array()).collect(),
        });
    }
    let corners = |row: [[u8; 4]; 3]| row.map(u32::from_le_bytes);
    mesh.indices = inflater.array(counts.triangles, corners)?;
    Ok(mesh)
}

fn read_vectors(
    inflater: &mut Inflater<'_>,
    count: u64,
    is_double: bool,
) -> Result<Vec<Vec3>, MeshError> {
    if is_double {
        let vector = |row: [[u8; 8]; 3]| DVec3::from_array(row.map(f64::from_le_bytes)).as_vec3();
        inflater.array(count, vector)
    } else {
        let vector = |row: [[u8; 4]; 3]| Vec3::from_array(row.map(f32::from_le_bytes));
        inflater.array(count, vector)
    }
}
