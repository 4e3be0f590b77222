//! `ply`: Stanford PLY files.

use crate::builder::Assets;
use crate::manual::{Manual, parameter};
use crate::models::mesh::Mesh;
use etendue_document::{Fault, Parameters};
use etendue_mesh::{PlyMesh, read_ply};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A mesh from a PLY file, ascii or binary of either byte order. Vertex and face properties \
              that are not geometry are kept as attributes.",
    parameters: &[
        parameter("filename", "string", "", "The file."),
        parameter("face_normals", "boolean", "false", "Ignore the file's normals: flat facets."),
        parameter("flip_tex_coords", "boolean", "false", "Turn v into 1 − v."),
        parameter("flip_normals", "boolean", "false", "Turn front and back around."),
        parameter(
            "max_smooth_angle",
            "float",
            "",
            "Separate normals at edges sharper than this (degrees).",
        ),
        parameter("to_world", "transform", "", "Placement."),
    ],
    sample: r#"<shape type="ply"><string name="filename" value="sample.ply"/></shape>"#,
};

/// Reads the file and places the mesh.
#[must_use]
pub fn build(assets: &Assets<'_>, parameters: &Parameters<'_>) -> Option<Mesh> {
    let flip_texture_coordinates = parameters.boolean("flip_tex_coords", false);
    assets.read_mesh(parameters, |path, bytes| {
        let PlyMesh { mut mesh, warnings } = read_ply(bytes)?;
        for warning in warnings {
            let message = format!("{}: {warning}", path.display());
            parameters.warning(Fault::Geometry, "filename", message);
        }
        if flip_texture_coordinates {
            mesh.uvs.iter_mut().for_each(|uv| uv.y = 1.0 - uv.y);
        }
        Ok(mesh)
    })
}
