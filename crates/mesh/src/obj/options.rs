//! The options and the result of reading an OBJ file.

use super::warning::ObjWarning;
use crate::triangle_mesh::TriangleMesh;

/// Options for reading an OBJ file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObjOptions {
    /// Replace the second texture coordinate `v` by `1 − v`, for textures whose first row is at
    /// `v = 0`. Corners without a texture coordinate get (0, 0) either way. This is Mitsuba's
    /// `flip_tex_coords`, which is on by default there. Here the default is off: the values of the
    /// file.
    pub flip_texture_coordinates: bool,
}

/// The contents of an OBJ file.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjMesh {
    /// All faces of all objects and groups of the file.
    pub mesh: TriangleMesh,
    /// Parts of the file that the mesh does not represent, at most one warning of each kind.
    pub warnings: Vec<ObjWarning>,
}
