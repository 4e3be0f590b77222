//! Bounding volume hierarchy: builders, wide nodes, watertight traversal, instancing.
//!
//! A [`Bvh`] answers two queries about a ray: what it hits first ([`Bvh::intersect`]) and whether
//! it hits anything ([`Bvh::occluded`]). It is built from triangle meshes, bounding boxes of
//! primitives that the caller intersects itself ([`Primitives`]), and instances of other
//! hierarchies. It copies what it needs; once built it is immutable, `Send` and `Sync`.
//!
//! ```
//! use etendue_bvh::{BuildOptions, Bvh, GeometryView, NoPrimitives, TriangleMeshView};
//! use etendue_math::Ray;
//! use glam::Vec3;
//!
//! let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
//! let mesh = TriangleMeshView { positions: &positions, indices: &[[0, 1, 2]] };
//! let bvh = Bvh::build(&[GeometryView::Triangles(mesh)], &BuildOptions::default())?;
//! let ray = Ray::new(Vec3::new(0.25, 0.5, -1.0), Vec3::Z);
//! let hit = bvh.intersect(&ray, &NoPrimitives).expect("the ray points at the triangle");
//! assert_eq!((hit.t, hit.u, hit.v), (1.0, 0.25, 0.5));
//! assert_eq!((hit.geometry, hit.primitive), (0, 0));
//! # Ok::<(), etendue_bvh::BuildError>(())
//! ```
//!
//! # Watertightness
//!
//! No ray passes between two triangles that share an edge or a vertex, wherever the mesh lies and
//! whatever the direction of the ray. Two properties guarantee this:
//!
//! * The triangle test decides on which side of an edge a ray passes by a sign that is exact for
//!   the projected vertices, and a vertex is projected identically for every triangle that shares
//!   it (module `triangle`).
//! * Boxes are padded by more than the rounding errors of both tests, so that no box is missed in
//!   which the triangle test would report a hit (module `error_bounds`).
//!
//! Two triangles share an edge if the positions of its two vertices are equal. Across *instances*
//! the guarantee holds only as far as their transforms agree exactly.
//!
//! # Determinism
//!
//! The nearest hit is a function of the geometry and the ray alone. Of hits at equal distances, the
//! one with the lowest (instance, geometry, primitive) wins. The triangle test rounds identically
//! in every [`Tier`], so neither the instruction set nor the build options change a hit.
//!
//! # Accuracy of a hit
//!
//! `t`, `u` and `v` come from sums without cancellation: `u` and `v` are not negative, and their
//! sum exceeds 1 only by rounding. The interpolated position `(1-u-v) p0 + u p1 + v p2` is within
//! γ₇ · (|(1-u-v) p0| + |u p1| + |v p2|) of the triangle's plane in each coordinate, where
//! γ₇ = 7ε/(1-7ε) and ε = 2⁻²⁴ (Pharr, Jakob and Humphreys, *Physically Based Rendering*, 4th ed.,
//! section 6.8.5). `origin + t · direction` is less accurate for distant origins.

mod build;
mod bvh;
mod depth;
mod error;
mod error_bounds;
mod geometry;
mod hit;
mod memory;
mod node;
mod options;
mod simd;
mod statistics;
mod traverse;
mod triangle;
mod triangle_ids;
mod validate;

pub use bvh::Bvh;
pub use error::BuildError;
pub use geometry::{GeometryView, NoPrimitives, PrimitiveHit, Primitives, TriangleMeshView};
pub use hit::Hit;
pub use options::BuildOptions;
pub use simd::Tier;
pub use statistics::Statistics;
