//! The input of a build, and the interface to user primitives.

use crate::bvh::Bvh;
use etendue_math::{Bounds3, Ray};
use glam::{Affine3A, Vec3};
use std::sync::Arc;

/// A borrowed triangle mesh: vertex positions, and three vertex indices per triangle.
#[derive(Clone, Copy, Debug)]
pub struct TriangleMeshView<'a> {
    /// The vertex positions.
    pub positions: &'a [Vec3],
    /// The vertex indices of each triangle.
    pub indices: &'a [[u32; 3]],
}

/// One geometry of the list that a hierarchy is built from. Its index in the list identifies it in
/// [`Hit`](crate::Hit).
#[derive(Clone, Debug)]
pub enum GeometryView<'a> {
    /// A triangle mesh. Degenerate triangles are never hit.
    Triangles(TriangleMeshView<'a>),
    /// Primitives that [`Primitives`] intersects, given by their bounding boxes. A primitive with
    /// an empty box is never hit.
    User(&'a [Bounds3]),
    /// Another hierarchy, placed by a transform. The group must not contain instances itself.
    Instance {
        /// The hierarchy, which any number of instances may share.
        group: Arc<Bvh>,
        /// Transforms the group's space into the space of the hierarchy being built.
        to_world: Affine3A,
    },
}

/// Where a ray hits a user primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimitiveHit {
    /// The ray parameter.
    pub t: f32,
    /// The first surface parameter, copied to [`Hit`](crate::Hit).
    pub u: f32,
    /// The second surface parameter, copied to [`Hit`](crate::Hit).
    pub v: f32,
}

/// The user primitives of a hierarchy. The traversal calls these where a ray meets their boxes.
pub trait Primitives {
    /// The nearest hit of `ray` with one primitive, `0 < t < ray.t_max`, or `None`.
    ///
    /// `ray.t_max` is the distance of the nearest hit so far. Inside an instance the ray is in the
    /// group's space with the same `t`, and `geometry` is an index into the group.
    fn intersect(&self, geometry: u32, primitive: u32, ray: &Ray) -> Option<PrimitiveHit>;

    /// Whether `ray` hits the primitive.
    fn occludes(&self, geometry: u32, primitive: u32, ray: &Ray) -> bool {
        self.intersect(geometry, primitive, ray).is_some()
    }

    /// As [`Primitives::intersect`], for a primitive in the group of `instance`. Override it if
    /// different groups use the same indices for different primitives.
    fn intersect_in(
        &self,
        instance: u32,
        geometry: u32,
        primitive: u32,
        ray: &Ray,
    ) -> Option<PrimitiveHit> {
        let _ = instance;
        self.intersect(geometry, primitive, ray)
    }

    /// As [`Primitives::occludes`], for a primitive in the group of `instance`.
    fn occludes_in(&self, instance: u32, geometry: u32, primitive: u32, ray: &Ray) -> bool {
        let _ = instance;
        self.occludes(geometry, primitive, ray)
    }
}

/// For scenes of triangles only: user primitives are never hit.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPrimitives;

impl Primitives for NoPrimitives {
    #[inline]
    fn intersect(&self, _: u32, _: u32, _: &Ray) -> Option<PrimitiveHit> {
        None
    }
}
