//! Wavefront OBJ (the polygonal part of *Advanced Visualizer manual, appendix B1*).

mod reader;
mod warning;
mod weld;
mod write;

pub use warning::{ObjWarning, ObjWarningKind};
pub use write::write_obj;

use crate::error::MeshError;
use crate::triangle_mesh::TriangleMesh;
use reader::{Reader, Statements};

/// How an OBJ file is to be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObjOptions {
    /// Turn the second texture coordinate `v` into `1 − v`, for textures whose first row is at
    /// `v = 0`. Corners without a texture coordinate get (0, 0) either way. Mitsuba's
    /// `flip_tex_coords`, which is on by default there; here it is off: what the file says.
    pub flip_texture_coordinates: bool,
}

/// What an OBJ file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjMesh {
    /// All faces of all objects and groups of the file.
    pub mesh: TriangleMesh,
    /// What the file says that the mesh does not, at most one of each kind.
    pub warnings: Vec<ObjWarning>,
}

/// Reads an OBJ file.
///
/// - `v` takes three coordinates; a weight or colour after them is left out. `vt` takes one to
///   three, of which two are kept. `vn` takes three.
/// - `f` takes three or more corners `v`, `v/vt`, `v//vn` or `v/vt/vn`, which may differ within a
///   face; negative indices count back from the latest vertex, positive ones may point ahead.
///   Polygons are split as a fan, concave ones by clipping ears.
/// - One vertex is made for each different triple of indices, in the order of first use.
///   A corner without a texture coordinate gets (0, 0); one without a normal, in a file that has
///   some, gets the angle-weighted normal of the faces around it, as do normals without direction
///   or with numbers that are not finite.
/// - The mesh has the name of the first object (`o`). Objects, groups, smoothing groups and
///   materials do not divide it.
///
/// Every file is read in one pass, unless a face points ahead: then in two.
///
/// # Errors
///
/// [`MeshErrorKind::Syntax`](crate::MeshErrorKind::Syntax) where a statement is not as above or
/// nothing looks like an OBJ file, [`OutOfRange`](crate::MeshErrorKind::OutOfRange) for an index
/// without a vertex, [`NonFinite`](crate::MeshErrorKind::NonFinite) for a position or texture
/// coordinate that single precision does not hold, and
/// [`Limit`](crate::MeshErrorKind::Limit) for more than 2³² − 2 vertices; all but the last with the
/// line.
pub fn read_obj(bytes: &[u8], options: &ObjOptions) -> Result<ObjMesh, MeshError> {
    let mut reader = Reader::new();
    match reader.read(bytes, Statements::All) {
        Err(_) if reader.points_ahead() => {
            reader = Reader::new();
            reader.read(bytes, Statements::Vertices)?;
            reader.read(bytes, Statements::Faces)?;
        }
        result => result?,
    }
    reader.finish(options)
}
