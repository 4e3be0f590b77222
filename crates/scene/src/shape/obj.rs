//! `obj`: Wavefront OBJ files.

use crate::builder::Assets;
use crate::manual::{Manual, parameter};
use crate::models::mesh::Mesh;
use etendue_document::{Fault, Parameters};
use etendue_mesh::{ObjOptions, read_obj};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A mesh from a Wavefront OBJ file. Polygons become triangle fans; negative indices, and \
              missing normals or texture coordinates, are understood. Materials in the file are ignored.",
    parameters: &[
        parameter("filename", "string", "", "The file."),
        parameter("face_normals", "boolean", "false", "Ignore the file's normals: flat facets."),
        parameter(
            "flip_tex_coords",
            "boolean",
            "true",
            "Turn v into 1 − v, as most tools write it.",
        ),
        parameter("flip_normals", "boolean", "false", "Turn front and back around."),
        parameter(
            "max_smooth_angle",
            "float",
            "",
            "Separate normals at edges sharper than this (degrees).",
        ),
        parameter("to_world", "transform", "", "Placement."),
    ],
    sample: r#"<shape type="obj"><string name="filename" value="sample.obj"/></shape>"#,
};

/// Reads the file and places the mesh.
#[must_use]
pub fn build(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Mesh> {
    let flip_texture_coordinates = parameters.boolean("flip_tex_coords", true);
    assets.read_mesh(parameters, |path, bytes| {
        let read = read_obj(bytes, &ObjOptions { flip_texture_coordinates })?;
        for warning in read.warnings {
            let message = format!("{}: {warning}", path.display());
            parameters.warning(Fault::Unsupported, "filename", message);
        }
        Ok(read.mesh)
    })
}
