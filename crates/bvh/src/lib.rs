//! Bounding volume hierarchy: builders, wide nodes, watertight traversal, instancing.
//!
//! A [`Bvh`] answers two questions about a ray: what it hits first ([`Bvh::intersect`]) and
//! whether it hits anything ([`Bvh::occluded`]). It is built once from triangle meshes, boxes of
//! primitives that the caller intersects itself ([`Primitives`]), and instances of other
//! hierarchies; it copies what it needs and is immutable, `Send` and `Sync` afterwards.
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
//! # Watertight
//!
//! No ray passes between two triangles that share an edge or a vertex, wherever the mesh lies and
//! however the ray is aimed. Two things together make it so:
//!
//! * the triangle test decides on which side of an edge the ray passes by a sign that is exact for
//!   the projected vertices, and a vertex is projected alike for every triangle that shares it
//!   (module `triangle`);
//! * a box is enlarged by more than the rounding of both tests, so that no box is missed in which
//!   the triangle test would report a hit (module `error_bounds`).
//!
//! Triangles share an edge if its two vertices are equal in position. Across two *instances* the
//! promise holds only as far as their transforms agree exactly.
//!
//! # The same hit everywhere
//!
//! The nearest hit is a function of the geometry and the ray: where two hits are equally far, the
//! lower (instance, geometry, primitive) counts. The triangle test rounds alike in every
//! [`Tier`], so neither the instruction set nor the build options change a hit.
//!
//! # Accuracy of a hit
//!
//! `t`, `u` and `v` come from sums without cancellation: `u` and `v` are not negative, and their
//! sum exceeds 1 by no more than rounding. Interpolating the position by the barycentrics, `(1-u-v) p0 + u p1 + v p2`, gives a
//! point whose coordinates are within γ₇ · (|(1-u-v) p0| + |u p1| + |v p2|) of the triangle's
//! plane section it stands for, γ₇ = 7ε/(1-7ε) with ε = 2⁻²⁴ (Pharr, Jakob and Humphreys,
//! *Physically Based Rendering*, 4th ed., section 6.8.5); `origin + t · direction` is less exact
//! for distant origins.

mod build;
mod bvh;
mod error;
mod error_bounds;
mod geometry;
mod instance;
mod memory;
mod node;
mod options;
mod simd;
mod statistics;
mod traverse;
mod triangle;
mod triangle_numbers;
mod validate;

pub use bvh::{Bvh, Hit};
pub use error::BuildError;
pub use geometry::{GeometryView, NoPrimitives, PrimitiveHit, Primitives, TriangleMeshView};
pub use options::BuildOptions;
pub use simd::Tier;
pub use statistics::Statistics;
