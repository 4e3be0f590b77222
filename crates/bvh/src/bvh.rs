//! The hierarchy itself. Each operation is in the module that implements it: `build`, `traverse`,
//! `statistics`, `validate`.

use crate::node::{Custom, Node, TriangleBlock};
use crate::simd::Tier;
use crate::triangle_ids::TriangleIds;
use etendue_math::{Bounds3, Ray};
use glam::Affine3A;
use std::sync::Arc;

/// A bounding volume hierarchy over triangles, user primitives and instances.
///
/// Immutable, and independent of the data it was built from.
#[derive(Clone, Debug)]
pub struct Bvh {
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<TriangleBlock>,
    pub(crate) triangle_ids: TriangleIds,
    pub(crate) custom: Vec<Custom>,
    pub(crate) instances: Vec<Instance>,
    pub(crate) bounds: Bounds3,
    pub(crate) triangle_count: usize,
    /// Always a tier for which [`Tier::is_available`] holds: the traversal relies on it.
    pub(crate) tier: Tier,
}

/// Another hierarchy, placed by a transform.
#[derive(Clone, Debug)]
pub(crate) struct Instance {
    pub(crate) group: Arc<Bvh>,
    pub(crate) geometry: u32,
    to_local: Affine3A,
}

impl Bvh {
    /// The box around everything.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// The memory that this hierarchy holds in bytes, without the groups of its instances.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + size_of_val(self.nodes.as_slice())
            + size_of_val(self.blocks.as_slice())
            + self.triangle_ids.memory_bytes()
            + size_of_val(self.custom.as_slice())
            + size_of_val(self.instances.as_slice())
    }

    /// The instruction set that queries use.
    #[inline]
    #[must_use]
    pub fn tier(&self) -> Tier {
        self.tier
    }

    /// The same hierarchy with another instruction set for queries; unchanged if the machine does
    /// not support it. The groups of instances keep theirs.
    #[must_use]
    pub fn with_tier(mut self, tier: Tier) -> Self {
        if tier.is_available() {
            self.tier = tier;
        }
        self
    }
}

impl Instance {
    /// `None` if the transform is not finite or has no finite inverse.
    pub(crate) fn new(group: Arc<Bvh>, geometry: u32, to_world: Affine3A) -> Option<Self> {
        let to_local = to_world.inverse();
        (to_world.is_finite() && to_local.is_finite()).then_some(Self { group, geometry, to_local })
    }

    /// Transforms a ray to the group's space. The direction is not normalised, so `t` is preserved.
    #[inline]
    pub(crate) fn to_local(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.to_local.transform_point3(ray.origin),
            direction: self.to_local.transform_vector3(ray.direction),
            t_max: ray.t_max,
        }
    }
}
