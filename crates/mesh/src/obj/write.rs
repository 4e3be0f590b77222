//! A small OBJ writer, for tests and generated scenes.

use crate::triangle_mesh::TriangleMesh;
use std::fmt::Write;

/// Writes the mesh as an OBJ file. Numbers round-trip exactly. Attributes are dropped, because OBJ
/// has no place for them.
#[must_use]
pub fn write_obj(mesh: &TriangleMesh) -> Vec<u8> {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_statements(mesh, &mut text);
    text.into_bytes()
}

fn write_statements(mesh: &TriangleMesh, text: &mut String) -> std::fmt::Result {
    if !mesh.name.is_empty() {
        // A line end in a name would start a statement.
        writeln!(text, "o {}", mesh.name.replace(['\n', '\r', '\\'], " "))?;
    }
    for position in &mesh.positions {
        writeln!(text, "v {} {} {}", position.x, position.y, position.z)?;
    }
    for uv in &mesh.uvs {
        writeln!(text, "vt {} {}", uv.x, uv.y)?;
    }
    for normal in &mesh.normals {
        writeln!(text, "vn {} {} {}", normal.x, normal.y, normal.z)?;
    }
    for corners in &mesh.indices {
        text.push('f');
        for index in corners.map(|index| u64::from(index) + 1) {
            match (mesh.uvs.is_empty(), mesh.normals.is_empty()) {
                (true, true) => write!(text, " {index}")?,
                (false, true) => write!(text, " {index}/{index}")?,
                (true, false) => write!(text, " {index}//{index}")?,
                (false, false) => write!(text, " {index}/{index}/{index}")?,
            }
        }
        text.push('\n');
    }
    Ok(())
}
