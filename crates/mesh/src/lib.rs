//! Triangle meshes from OBJ, PLY and Mitsuba's serialized format.
//!
//! Bytes in, an indexed [`TriangleMesh`] out; no file is opened here. Every reader takes its input
//! as hostile: counts in headers are compared with the bytes that are really there before memory is
//! taken, indices are checked, and numbers must be finite. What comes out of a reader has passed
//! [`TriangleMesh::validate`].
//!
//! Coordinates are whatever unit and space the file has; nothing is scaled or transformed.
#![forbid(unsafe_code)]

mod creases;
mod error;
mod normals;
mod number;
mod obj;
mod ply;
mod polygon;
mod serialized;
mod text;
mod triangle_mesh;

pub use error::{MeshError, MeshErrorKind};
pub use obj::{ObjMesh, ObjOptions, ObjWarning, ObjWarningKind, read_obj, write_obj};
pub use ply::{read_ply, write_ply};
pub use serialized::{read_serialized, serialized_shape_count};
pub use triangle_mesh::{Attribute, AttributeDomain, TriangleMesh};
