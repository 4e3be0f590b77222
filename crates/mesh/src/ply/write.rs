//! A small PLY writer, for tests and generated scenes.

use crate::triangle_mesh::{Attribute, AttributeDomain, TriangleMesh};

/// Writes the mesh as a binary little-endian PLY file. Attributes are written as by Mitsuba 3: the
/// channels of `vertex_foo` are the properties `foo_0`, `foo_1`, … of the vertices. The name of the
/// mesh is dropped, because PLY has no place for it.
///
/// # Panics
///
/// If the mesh is not valid.
#[must_use]
pub fn write_ply(mesh: &TriangleMesh) -> Vec<u8> {
    let mut bytes = header(mesh).into_bytes();
    for vertex in 0..mesh.positions.len() {
        put(&mut bytes, &mesh.positions[vertex].to_array());
        if !mesh.normals.is_empty() {
            put(&mut bytes, &mesh.normals[vertex].to_array());
        }
        if !mesh.uvs.is_empty() {
            put(&mut bytes, &mesh.uvs[vertex].to_array());
        }
        put_attributes(&mut bytes, mesh, AttributeDomain::Vertex, vertex);
    }
    for (face, corners) in mesh.indices.iter().enumerate() {
        bytes.push(3);
        bytes.extend(corners.iter().flat_map(|index| index.to_le_bytes()));
        put_attributes(&mut bytes, mesh, AttributeDomain::Face, face);
    }
    bytes
}

fn header(mesh: &TriangleMesh) -> String {
    let mut text =
        format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len());
    let mut properties = vec!["x", "y", "z"];
    if !mesh.normals.is_empty() {
        properties.extend(["nx", "ny", "nz"]);
    }
    if !mesh.uvs.is_empty() {
        properties.extend(["u", "v"]);
    }
    text.extend(properties.into_iter().map(|name| format!("property float {name}\n")));
    text.extend(attribute_lines(mesh, AttributeDomain::Vertex));
    text.push_str(&format!("element face {}\n", mesh.indices.len()));
    text.push_str("property list uchar uint vertex_indices\n");
    text.extend(attribute_lines(mesh, AttributeDomain::Face));
    text.push_str("end_header\n");
    text
}

fn of_domain(mesh: &TriangleMesh, domain: AttributeDomain) -> impl Iterator<Item = &Attribute> {
    mesh.attributes.iter().filter(move |attribute| attribute.domain == domain)
}

fn attribute_lines(mesh: &TriangleMesh, domain: AttributeDomain) -> impl Iterator<Item = String> {
    of_domain(mesh, domain).flat_map(move |attribute| {
        let name = &attribute.name;
        let stem = name.strip_prefix(domain.prefix()).unwrap_or(name);
        let stem = stem.replace(|letter: char| letter.is_whitespace(), "_");
        (0..attribute.channels).map(move |channel| format!("property float {stem}_{channel}\n"))
    })
}

fn put_attributes(bytes: &mut Vec<u8>, mesh: &TriangleMesh, domain: AttributeDomain, row: usize) {
    for attribute in of_domain(mesh, domain) {
        let channels = attribute.channels as usize;
        put(bytes, &attribute.values[row * channels..][..channels]);
    }
}

fn put(bytes: &mut Vec<u8>, values: &[f32]) {
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}
