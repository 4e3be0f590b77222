//! Wavefront OBJ: the polygonal part (*Advanced Visualizer manual, appendix B1*).

mod options;
mod reader;
mod warning;
mod weld;
mod write;

pub use options::{ObjMesh, ObjOptions};
pub use warning::{ObjWarning, ObjWarningKind};
pub use write::write_obj;

use crate::error::MeshError;
use reader::{Reader, Statements};

/// Reads an OBJ file.
///
/// - `v` takes three coordinates; a weight or colour after them is ignored. `vt` takes one to
///   three, of which two are used. `vn` takes three.
/// - `f` takes three or more corners `v`, `v/vt`, `v//vn` or `v/vt/vn`, which may be mixed within a
///   face. Negative indices count back from the latest vertex; positive ones may refer to later
///   vertices. Polygons are split as a fan, concave ones by ear clipping.
/// - Each distinct triple of indices becomes a vertex, in the order of first use. A corner without
///   a texture coordinate gets (0, 0). In a file with normals, a corner without one gets the
///   angle-weighted normal of the adjacent faces, as do zero normals and those that are not finite.
///   Texture coordinates that are not finite are (0, 0); indices of texture coordinates and normals
///   that do not exist count as missing.
/// - The mesh gets the name of the first object (`o`). Objects, groups, smoothing groups and
///   materials do not divide it.
///
/// A file is read in one pass, or in two if a face refers to a later vertex.
///
/// # Errors
///
/// [`MeshErrorKind::Syntax`](crate::MeshErrorKind::Syntax) for a malformed statement or a file that
/// does not look like OBJ, [`OutOfRange`](crate::MeshErrorKind::OutOfRange) for an index without a
/// position, [`NonFinite`](crate::MeshErrorKind::NonFinite) for a position that is not finite in
/// single precision, and [`Limit`](crate::MeshErrorKind::Limit) for more than
/// 2³² − 2 vertices. All but the last have a line.
pub fn read_obj(bytes: &[u8], options: &ObjOptions) -> Result<ObjMesh, MeshError> {
    let mut reader = Reader::new();
    match reader.read(bytes, Statements::All) {
        Err(_) if reader.refers_ahead() => {
            reader = Reader::new();
            reader.read(bytes, Statements::Vertices)?;
            reader.read(bytes, Statements::Faces)?;
        }
        result => result?,
    }
    reader.finish(options)
}
