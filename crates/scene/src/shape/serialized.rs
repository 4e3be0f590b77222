//! `serialized`: Mitsuba's own compressed mesh format.

use crate::builder::Assets;
use crate::manual::{Manual, parameter};
use crate::models::mesh::Mesh;
use etendue_document::{Fault, Parameters};
use etendue_mesh::{has_shape_list, read_serialized};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A mesh from a file in Mitsuba's serialized format, versions 3 and 4.",
    parameters: &[
        parameter("filename", "string", "", "The file."),
        parameter("shape_index", "integer", "0", "Which of the file's meshes, counted from zero."),
        parameter("face_normals", "boolean", "false", "Ignore the file's normals: flat facets."),
        parameter("flip_normals", "boolean", "false", "Turn front and back around."),
        parameter(
            "max_smooth_angle",
            "float",
            "",
            "Separate normals at edges sharper than this (degrees).",
        ),
        parameter("to_world", "transform", "", "Placement."),
    ],
    sample: r#"<shape type="serialized"><string name="filename" value="sample.serialized"/></shape>"#,
};

/// Reads the file and places the mesh.
#[must_use]
pub fn build(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Mesh> {
    // In range: validated when read.
    let shape_index = parameters.integer_in("shape_index", 0, 0..=i64::from(u32::MAX)) as u32;
    assets.read_mesh(parameters, |path, bytes| {
        if !has_shape_list(bytes)? {
            let path = path.display();
            let message = format!("{path}: the list of shapes is missing: only the first is known");
            parameters.warning(Fault::Geometry, "filename", message);
        }
        read_serialized(bytes, shape_index)
    })
}
