//! `mesh`: a triangle mesh from arrays in memory.

use crate::builder::Assets;
use crate::manual::{Manual, parameter};
use crate::models::mesh::{Mesh, MeshOptions};
use etendue_document::{Buffer, Fault, Parameters};
use etendue_mesh::{Attribute, AttributeDomain, MeshErrorKind, TriangleMesh};
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A mesh from arrays in memory, for scenes that are built in code: there is no file. Arrays \
              are buffers, of rows or flat; floats of 16, 32 or 64 bits, and integers of any size for \
              `indices`. The same mesh from a PLY file gives the same picture.",
    parameters: &[
        parameter("positions", "buffer", "", "Rows of three: the vertices; required."),
        parameter(
            "indices",
            "buffer",
            "",
            "Rows of three: the vertices of each triangle, counterclockwise from its front. Without \
             them, every three vertices are a triangle.",
        ),
        parameter("normals", "buffer", "", "Rows of three: the shading normal of each vertex."),
        parameter("uv", "buffer", "", "Rows of two: the coordinates of each vertex."),
        parameter(
            "vertex_*",
            "buffer",
            "",
            "An attribute of the vertices, such as `vertex_color`, for the texture `mesh_attribute`. \
             Integers of 8 and 16 bits are fractions of their largest value.",
        ),
        parameter("face_*", "buffer", "", "An attribute of the triangles, likewise."),
        parameter("face_normals", "boolean", "false", "Ignore the normals: flat facets."),
        parameter("flip_normals", "boolean", "false", "Turn front and back around."),
        parameter(
            "max_smooth_angle",
            "float",
            "",
            "Separate normals at edges sharper than this (degrees).",
        ),
        parameter("to_world", "transform", "", "Placement."),
    ],
    sample: include_str!("mesh/sample.rs"),
};

/// Reads the arrays and places the mesh.
#[must_use]
pub fn build(_: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Mesh> {
    let options = MeshOptions::read(parameters);
    let mesh = read(parameters)?;
    if let Err(error) = mesh.validate() {
        let name = match error.kind {
            MeshErrorKind::OutOfRange => "indices",
            _ => "positions",
        };
        parameters.error(Fault::Geometry, name, error.to_string());
        return None;
    }
    let placed = Mesh::new(mesh, &options?);
    placed.map_err(|error| parameters.error(Fault::Geometry, "", error.to_string())).ok()
}

/// Builds the mesh from the arrays without validating it. Returns `None` after reporting arrays
/// with the wrong shape or type.
fn read(parameters: &Parameters<'_>) -> Option<TriangleMesh> {
    if !parameters.has("positions") {
        let message = "`mesh` needs the parameter `positions`";
        parameters.error(Fault::MissingParameter, "positions", message);
    }
    // Read all arrays before returning, so that one run reports all errors.
    let positions = vectors::<3>(parameters, "positions");
    let normals = vectors::<3>(parameters, "normals");
    let uvs = vectors::<2>(parameters, "uv");
    let vertex_count = positions.as_ref().map_or(0, Vec::len);
    let indices = triangles(parameters, vertex_count);
    let triangle_count = indices.as_ref().map_or(0, Vec::len);
    let vertex_attributes = attributes(parameters, AttributeDomain::Vertex, vertex_count);
    let face_attributes = attributes(parameters, AttributeDomain::Face, triangle_count);
    parameters.has("positions").then_some(())?;
    Some(TriangleMesh {
        name: String::new(),
        positions: positions?.into_iter().map(Vec3::from).collect(),
        normals: normals?.into_iter().map(Vec3::from).collect(),
        uvs: uvs?.into_iter().map(Vec2::from).collect(),
        indices: indices?,
        attributes: [vertex_attributes?, face_attributes?].concat(),
    })
}

/// Reads a buffer with rows of `N` floats. Empty if absent; `None` after reporting an error.
fn vectors<const N: usize>(parameters: &Parameters<'_>, name: &str) -> Option<Vec<[f32; N]>> {
    let Some(buffer) = buffer(parameters, name)? else {
        return Some(Vec::new());
    };
    check_rows(parameters, name, buffer, N)?;
    let Some(values) = buffer.to_floats() else {
        return wrong_type(parameters, name, buffer, "floats");
    };
    Some(values.as_chunks::<N>().0.to_vec())
}

/// The vertex indices of each triangle.
fn triangles(parameters: &Parameters<'_>, vertex_count: usize) -> Option<Vec<[u32; 3]>> {
    let Some(buffer) = buffer(parameters, "indices")? else {
        return consecutive_triangles(parameters, vertex_count);
    };
    check_rows(parameters, "indices", buffer, 3)?;
    match buffer.to_indices() {
        Some(Ok(indices)) => Some(indices.as_chunks::<3>().0.to_vec()),
        Some(Err(index)) => {
            let message = format!("`indices` holds {index}, which is not a vertex");
            parameters.error(Fault::Geometry, "indices", message);
            None
        }
        None => wrong_type(parameters, "indices", buffer, "integers"),
    }
}

/// Groups every three vertices into a triangle.
fn consecutive_triangles(
    parameters: &Parameters<'_>,
    vertex_count: usize,
) -> Option<Vec<[u32; 3]>> {
    if !vertex_count.is_multiple_of(3) {
        let message = format!(
            "without `indices`, every three vertices are a triangle, but there are {vertex_count}"
        );
        parameters.error(Fault::Geometry, "positions", message);
        return None;
    }
    // Mesh validation rejects larger counts.
    let count = u32::try_from(vertex_count).unwrap_or(0);
    Some((0..count / 3).map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner)).collect())
}

/// The attributes of a domain with `count` elements.
fn attributes(
    parameters: &Parameters<'_>,
    domain: AttributeDomain,
    count: usize,
) -> Option<Vec<Attribute>> {
    let read = |(name, buffer): (&str, &Buffer)| {
        let Some(values) = buffer.to_fractions() else {
            return wrong_type(parameters, name, buffer, "floats, bytes or 16-bit integers");
        };
        let channels = values.len().checked_div(count).unwrap_or(1).max(1);
        // A buffer of rows has one row per element. For a flat buffer, the length determines the
        // channels.
        let is_shaped = buffer.shape().len() > 1;
        if channels * count != values.len() || is_shaped && buffer.shape()[0] != count {
            let message = format!(
                "`{name}` has the shape {:?}, but there are {count} {}",
                buffer.shape(),
                match domain {
                    AttributeDomain::Vertex => "vertices",
                    AttributeDomain::Face => "triangles",
                }
            );
            parameters.error(Fault::BadValue, name, message);
            return None;
        }
        Some(Attribute { name: name.to_owned(), domain, channels: channels as u32, values })
    };
    let found = parameters.buffers_with_prefix(domain.prefix());
    // Read all of them, so that all errors are reported.
    let all: Vec<Option<Attribute>> = found.into_iter().map(read).collect();
    all.into_iter().collect()
}

/// The buffer with that name, if present; `None` after reporting a value of another type.
fn buffer<'a>(parameters: &Parameters<'a>, name: &str) -> Option<Option<&'a Buffer>> {
    match parameters.buffer(name) {
        None if parameters.has(name) => None,
        found => Some(found),
    }
}

fn check_rows(
    parameters: &Parameters<'_>,
    name: &str,
    buffer: &Buffer,
    columns: usize,
) -> Option<usize> {
    let rows = buffer.rows(columns);
    if rows.is_none() {
        let message =
            format!("`{name}` has the shape {:?}, but needs rows of {columns}", buffer.shape());
        parameters.error(Fault::BadValue, name, message);
    }
    rows
}

fn wrong_type<T>(
    parameters: &Parameters<'_>,
    name: &str,
    buffer: &Buffer,
    wanted: &str,
) -> Option<T> {
    let message = format!("`{name}` must hold {wanted}, not {}", buffer.elements().type_name());
    parameters.error(Fault::BadValue, name, message);
    None
}
