//! The hierarchy itself.

use crate::build;
use crate::error::BuildError;
use crate::geometry::{GeometryView, Primitives};
use crate::instance::Instance;
use crate::node::{Custom, Node, TriangleBlock};
use crate::options::BuildOptions;
use crate::simd::Tier;
use crate::statistics::Statistics;
use crate::triangle_numbers::TriangleNumbers;
use crate::{traverse, validate};
use etendue_math::{Bounds3, Ray};

/// A bounding volume hierarchy over triangles, user primitives and instances.
///
/// Immutable, and independent of what it was built from.
#[derive(Clone, Debug)]
pub struct Bvh {
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<TriangleBlock>,
    pub(crate) names: TriangleNumbers,
    pub(crate) custom: Vec<Custom>,
    pub(crate) instances: Vec<Instance>,
    pub(crate) bounds: Bounds3,
    pub(crate) triangle_count: usize,
    tier: Tier,
}

/// Where a ray hits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray parameter: the hit is at `origin + t · direction`.
    pub t: f32,
    /// The barycentric coordinate of the triangle's vertex 1, or what a user primitive reported.
    pub u: f32,
    /// The barycentric coordinate of the triangle's vertex 2, or what a user primitive reported.
    pub v: f32,
    /// The number of the geometry in the list that the hierarchy, or the instance's group, was
    /// built from.
    pub geometry: u32,
    /// The number of the triangle or user primitive in its geometry.
    pub primitive: u32,
    /// The number of the geometry that is the instance, or [`Hit::NO_INSTANCE`].
    pub instance: u32,
}

impl Hit {
    /// The `instance` of hits that are in none.
    pub const NO_INSTANCE: u32 = u32::MAX;
}

impl Bvh {
    /// Builds a hierarchy, on the threads of the current `rayon` pool. The result does not depend
    /// on how many these are.
    ///
    /// # Errors
    ///
    /// [`BuildError`] for vertices or boxes that are not finite, indices out of range, transforms
    /// without an inverse, instances of instances, and more primitives than can be numbered
    /// (over two thousand million triangles, or 134 million user primitives and instances).
    pub fn build(
        geometries: &[GeometryView<'_>],
        options: &BuildOptions,
    ) -> Result<Self, BuildError> {
        build::build(geometries, options)
    }

    pub(crate) fn from_parts(
        nodes: Vec<Node>,
        (blocks, names): (Vec<TriangleBlock>, TriangleNumbers),
        (custom, instances): (Vec<Custom>, Vec<Instance>),
        bounds: Bounds3,
        triangle_count: usize,
    ) -> Self {
        Self {
            nodes,
            blocks,
            names,
            custom,
            instances,
            bounds,
            triangle_count,
            tier: Tier::detect(),
        }
    }

    /// The nearest hit with `0 < t < ray.t_max`.
    ///
    /// The direction need not be of unit length. A ray with a coordinate that is not finite, or a
    /// direction whose components are all zero or subnormal, hits nothing. Where hits are equally
    /// far, the lowest (instance, geometry, primitive) counts.
    #[inline]
    #[must_use]
    pub fn intersect<P: Primitives>(&self, ray: &Ray, primitives: &P) -> Option<Hit> {
        traverse::intersect(self, ray, primitives, Hit::NO_INSTANCE)
    }

    /// Whether there is any hit with `0 < t < ray.t_max`: cheaper than [`Bvh::intersect`], and
    /// true exactly where that finds a hit.
    #[inline]
    #[must_use]
    pub fn occluded<P: Primitives>(&self, ray: &Ray, primitives: &P) -> bool {
        traverse::occluded(self, ray, primitives, Hit::NO_INSTANCE)
    }

    /// As [`Bvh::intersect`] for many rays, whose hits are appended to `hits`.
    ///
    /// Through hierarchies of a few hundred triangles, and where neighbours in the list start near
    /// each other and go the same way, the rays travel in packets, which on x86-64 is two to four
    /// times as fast. The hits are the same to the last bit.
    pub fn intersect_many<P: Primitives>(
        &self,
        rays: &[Ray],
        primitives: &P,
        hits: &mut Vec<Option<Hit>>,
    ) {
        traverse::many::intersect_many(self, rays, primitives, hits);
    }

    /// As [`Bvh::occluded`] for many rays; the answers are appended to `occluded`.
    pub fn occluded_many<P: Primitives>(
        &self,
        rays: &[Ray],
        primitives: &P,
        occluded: &mut Vec<bool>,
    ) {
        traverse::many::occluded_many(self, rays, primitives, occluded);
    }

    /// The box around everything.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// The memory that this hierarchy holds, in bytes, without the groups of its instances.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + size_of_val(self.nodes.as_slice())
            + size_of_val(self.blocks.as_slice())
            + self.names.memory_bytes()
            + size_of_val(self.custom.as_slice())
            + size_of_val(self.instances.as_slice())
    }

    /// Counts that describe the hierarchy.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        Statistics::of(self)
    }

    /// Checks the structure: every child is in its parent's box, everything is reached exactly
    /// once, and the depth is within what traversal allows.
    ///
    /// # Errors
    ///
    /// A sentence about the first flaw, which would be a defect of this crate.
    pub fn validate(&self) -> Result<(), String> {
        validate::validate(self)
    }

    /// The instructions that rays use.
    #[inline]
    #[must_use]
    pub fn tier(&self) -> Tier {
        self.tier
    }

    /// The same hierarchy, traversed by other instructions; unchanged where the machine does not
    /// have them. The groups of instances keep theirs.
    #[must_use]
    pub fn with_tier(mut self, tier: Tier) -> Self {
        if tier.is_available() {
            self.tier = tier;
        }
        self
    }
}
