//! Builds a hierarchy: references, then a binary tree, then wide nodes.

mod binary_tree;
mod binned;
mod bins;
mod collapse;
mod extent;
mod kernel;
mod plan;
mod presplit;
mod reference;
mod reinsert;
mod top;
mod top_node;

use crate::bvh::{Bvh, Instance};
use crate::error::BuildError;
use crate::geometry::GeometryView;
use crate::node::Child;
use crate::options::BuildOptions;
use crate::simd::Tier;
use crate::triangle_ids::TriangleIds;
use etendue_math::Bounds3;
use glam::Affine3A;
use std::sync::Arc;

impl Bvh {
    /// Builds a hierarchy on the threads of the current `rayon` pool. The result does not depend on
    /// the number of threads.
    ///
    /// # Errors
    ///
    /// [`BuildError`] for vertices or boxes that are not finite, indices out of range, transforms
    /// without an inverse, instances of instances, and too many primitives (over two billion
    /// triangles, or 134 million user primitives and instances).
    pub fn build(
        geometries: &[GeometryView<'_>],
        options: &BuildOptions,
    ) -> Result<Self, BuildError> {
        check_instances(geometries)?;
        let mut references = reference::collect(geometries)?;
        let mut split = presplit::presplit(&references, geometries, options.split_budget);
        if references.len().max(split.len()) >= Child::MAX_BLOCKS {
            return Err(BuildError::TooManyPrimitives);
        }
        let (mut tree, cost) = top::build(&mut references, options);
        // Spatial splits help some scenes and harm others: in rooms with large slanted walls, the
        // pieces enlarged so many nodes that rays took a third longer. The cost predicts which.
        if !split.is_empty() {
            let (split_tree, split_cost) = top::build(&mut split, options);
            if split_cost < cost {
                (references, tree) = (split, split_tree);
            }
        }
        let wide = collapse::collapse(&tree, &references);
        let triangle_count = wide.triangle_count;
        if wide.custom.len() > Child::MAX_CUSTOM_ENTRIES {
            return Err(BuildError::TooManyPrimitives);
        }
        let bounds = tree.root().map_or(Bounds3::EMPTY, |root| tree.node(root).bounds());
        // Memory use peaks below.
        drop(tree);
        let triangle_ids = TriangleIds::new(geometries.iter().map(triangle_count_of))
            .ok_or(BuildError::TooManyPrimitives)?;
        let blocks = wide.fill_blocks(&references, geometries, &triangle_ids);
        drop(references);
        // Only now: next to the tree, a million instances would be a sixth of all memory.
        let mut instances = Vec::with_capacity(count_instances(geometries));
        for instance in place_instances(geometries) {
            instances.push(instance?);
        }
        let (nodes, custom) = (wide.nodes, wide.custom);
        Ok(Self {
            nodes,
            blocks,
            triangle_ids,
            custom,
            instances,
            bounds,
            triangle_count,
            tier: Tier::detect(),
        })
    }
}

fn triangle_count_of(view: &GeometryView<'_>) -> usize {
    match view {
        GeometryView::Triangles(mesh) => mesh.indices.len(),
        GeometryView::User(_) | GeometryView::Instance { .. } => 0,
    }
}

/// The instances, in the order of the geometries.
fn place_instances(
    geometries: &[GeometryView<'_>],
) -> impl Iterator<Item = Result<Instance, BuildError>> {
    geometries.iter().enumerate().filter_map(|(index, view)| {
        let GeometryView::Instance { group, to_world } = view else { return None };
        Some(place_instance(index, group, *to_world))
    })
}

fn place_instance(
    index: usize,
    group: &Arc<Bvh>,
    to_world: Affine3A,
) -> Result<Instance, BuildError> {
    let geometry = u32::try_from(index).map_err(|_| BuildError::TooManyPrimitives)?;
    if !group.instances.is_empty() {
        return Err(BuildError::NestedInstance { geometry });
    }
    let instance = Instance::new(group.clone(), geometry, to_world);
    instance.ok_or(BuildError::SingularTransform { geometry })
}

/// Reports the first invalid instance.
fn check_instances(geometries: &[GeometryView<'_>]) -> Result<(), BuildError> {
    place_instances(geometries).try_for_each(|instance| instance.map(drop))
}

fn count_instances(geometries: &[GeometryView<'_>]) -> usize {
    let is_instance = |view: &&GeometryView<'_>| matches!(view, GeometryView::Instance { .. });
    geometries.iter().filter(is_instance).count()
}
