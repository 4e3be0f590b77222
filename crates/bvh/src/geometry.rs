//! What a hierarchy is built from, and the primitives that the caller intersects itself.

use crate::Bvh;
use etendue_math::{Bounds3, Ray};
use glam::{Affine3A, Vec3};
use std::sync::Arc;

/// Borrowed triangles: vertex positions, and three vertex numbers per triangle.
#[derive(Clone, Copy, Debug)]
pub struct TriangleMeshView<'a> {
    /// The vertices.
    pub positions: &'a [Vec3],
    /// The triangles.
    pub indices: &'a [[u32; 3]],
}

/// One geometry of the ordered list that a hierarchy is built from. Its place in the list is its
/// number in [`Hit`](crate::Hit).
#[derive(Clone, Debug)]
pub enum GeometryView<'a> {
    /// A triangle mesh. Triangles without area are never hit.
    Triangles(TriangleMeshView<'a>),
    /// Primitives that [`Primitives`] intersects, each given by a box around it. An empty box
    /// stands for a primitive that is never hit.
    User(&'a [Bounds3]),
    /// Another hierarchy, placed by a transform. The group must not hold instances itself.
    Instance {
        /// The hierarchy; any number of instances may share it.
        group: Arc<Bvh>,
        /// From the group's space to that of the hierarchy being built.
        to_world: Affine3A,
    },
}

/// Where a ray hits a user primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimitiveHit {
    /// The ray parameter.
    pub t: f32,
    /// The first surface parameter, handed through to [`Hit`](crate::Hit).
    pub u: f32,
    /// The second surface parameter, handed through to [`Hit`](crate::Hit).
    pub v: f32,
}

/// The user primitives of a hierarchy: the traversal calls these where a ray meets their boxes.
pub trait Primitives {
    /// The nearest hit of `ray` with one primitive, `0 < t < ray.t_max`, or `None`.
    ///
    /// `ray.t_max` is the nearest hit so far. Inside an instance the ray is in the group's space,
    /// with the same `t`, and `geometry` counts within the group.
    fn intersect(&self, geometry: u32, primitive: u32, ray: &Ray) -> Option<PrimitiveHit>;

    /// Whether `ray` hits the primitive at all.
    fn occludes(&self, geometry: u32, primitive: u32, ray: &Ray) -> bool {
        self.intersect(geometry, primitive, ray).is_some()
    }

    /// As [`Primitives::intersect`] for a primitive of the group of `instance`, for callers whose
    /// groups hold different primitives under the same numbers.
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

    /// As [`Primitives::occludes`] for a primitive of the group of `instance`.
    fn occludes_in(&self, instance: u32, geometry: u32, primitive: u32, ray: &Ray) -> bool {
        let _ = instance;
        self.occludes(geometry, primitive, ray)
    }
}

/// For scenes of triangles alone: user primitives, if there are any, are never hit.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPrimitives;

impl Primitives for NoPrimitives {
    #[inline]
    fn intersect(&self, _: u32, _: u32, _: &Ray) -> Option<PrimitiveHit> {
        None
    }
}
