//! Triangle meshes from OBJ, PLY and Mitsuba's serialized format.
//!
//! Bytes in, an indexed [`TriangleMesh`] out; this crate opens no files. Readers treat their input
//! as hostile: they compare the counts in headers with the size of the input before they allocate,
//! check indices, and reject numbers that are not finite. Meshes that a reader returns have passed
//! [`TriangleMesh::validate`].
//!
//! Coordinates keep the unit and space of the file; nothing is scaled or transformed.
//!
//! ```
//! use etendue_mesh::{MeshErrorKind, ObjOptions, read_obj};
//!
//! let text = b"v 0 0 0\nv 3 0 0\nv 3 4 0\nv 0 4 0\nf 1 2 3 4\n";
//! let mut mesh = read_obj(text, &ObjOptions::default())?.mesh;
//! assert_eq!((mesh.indices.len(), mesh.surface_area()), (2, 12.0));
//! mesh.compute_vertex_normals();
//! assert_eq!(mesh.normals[0].z, 1.0);
//!
//! let error = read_obj(b"v 0 0 0\nf 1 2 3\n", &ObjOptions::default()).unwrap_err();
//! assert_eq!((error.kind, error.line), (MeshErrorKind::OutOfRange, Some(2)));
//! # Ok::<(), etendue_mesh::MeshError>(())
//! ```
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
pub use ply::{PlyMesh, PlyWarning, read_ply, read_ply_points, write_ply};
pub use serialized::{has_shape_list, read_serialized, serialized_shape_count};
pub use triangle_mesh::{Attribute, AttributeDomain, TriangleMesh};
