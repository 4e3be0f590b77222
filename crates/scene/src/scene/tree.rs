//! The tree over shapes and instances.

use crate::cache::{AssetCache, Digest};
use crate::shape::instance::Instance;
use crate::shape::shapegroup::Group;
use crate::shape::{Geometry, Shape};
use etendue_bvh::{BuildOptions, Bvh, GeometryView, Tier, TriangleMeshView};
use etendue_math::Bounds3;
use std::sync::Arc;

/// The contents of a tree: shapes, followed by instances, which place `groups`.
#[derive(Clone, Copy, Default)]
pub(crate) struct TreeContent<'a> {
    pub(crate) shapes: &'a [Shape],
    pub(crate) instances: &'a [Instance],
    pub(crate) groups: &'a [Group],
    /// The digest of each shape; only with a cache.
    pub(crate) geometry_digests: &'a [u128],
    /// The digest of each group's tree; only with a cache.
    pub(crate) group_digests: &'a [u128],
}

/// A tree with a digest of all its inputs.
pub(crate) struct Tree {
    pub(crate) bvh: Arc<Bvh>,
    /// Zero without a cache.
    pub(crate) digest: u128,
}

impl TreeContent<'_> {
    /// Builds the tree, or takes the same tree from an earlier scene.
    pub(crate) fn build(
        &self,
        tier: Option<Tier>,
        cache: Option<&AssetCache>,
    ) -> Result<Tree, String> {
        let Some(cache) = cache else {
            return Ok(Tree { bvh: Arc::new(self.build_tree(tier)?), digest: 0 });
        };
        let digest = self.digest(tier);
        Ok(Tree { bvh: cache.tree(digest, || self.build_tree(tier))?, digest })
    }

    /// A digest of all inputs of the tree, including the instruction set for rays.
    fn digest(&self, tier: Option<Tier>) -> u128 {
        let mut digest = Digest::default();
        digest.text(&format!("{tier:?}"));
        for numbers in [self.geometry_digests, self.group_digests] {
            digest.number(numbers.len() as u128);
            numbers.iter().for_each(|number| digest.number(*number));
        }
        for instance in self.instances {
            digest.number(u128::from(instance.group.0));
            digest.floats(&instance.to_world().affine().to_cols_array());
        }
        digest.finish()
    }

    fn build_tree(&self, tier: Option<Tier>) -> Result<Bvh, String> {
        let boxes: Vec<Vec<Bounds3>> =
            self.shapes.iter().map(|shape| shape.geometry.primitive_boxes()).collect();
        let views: Vec<GeometryView<'_>> = self
            .shapes
            .iter()
            .zip(&boxes)
            .map(|(shape, boxes)| match &shape.geometry {
                Geometry::Mesh(mesh) => GeometryView::Triangles(TriangleMeshView {
                    positions: mesh.positions(),
                    indices: mesh.triangles(),
                }),
                _ => GeometryView::User(boxes),
            })
            .chain(self.instances.iter().map(|instance| GeometryView::Instance {
                group: Arc::clone(&self.groups[instance.group.index()].bvh),
                to_world: instance.to_world().affine(),
            }))
            .collect();
        let bvh =
            Bvh::build(&views, &BuildOptions::default()).map_err(|error| error.to_string())?;
        Ok(match tier {
            Some(tier) => bvh.with_tier(tier),
            None => bvh,
        })
    }
}
