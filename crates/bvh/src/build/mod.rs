//! From geometries to a hierarchy: references, a binary tree, wide nodes.

mod binned;
mod bins;
mod collapse;
mod extent;
mod kernel;
mod presplit;
mod reference;
mod reinsert;
mod top;

use self::binned::BinaryNode;
use crate::bvh::Bvh;
use crate::error::BuildError;
use crate::geometry::GeometryView;
use crate::instance::Instance;
use crate::names::Names;
use crate::node::Child;
use crate::options::BuildOptions;
use etendue_math::Bounds3;

/// The binary tree is split by cost down to this depth, and in halves below it.
const MAX_COST_DEPTH: usize = 48;

/// No part of the top is further from the root (see `top`), which leaves many splits by cost.
const MAX_TOP_DEPTH: usize = 28;

/// No tree is deeper: below [`MAX_COST_DEPTH`] every level halves the at most 2³¹ references.
pub(crate) const MAX_DEPTH: usize = MAX_COST_DEPTH + 32;

/// See [`Bvh::build`].
pub(crate) fn build(
    geometries: &[GeometryView<'_>],
    options: &BuildOptions,
) -> Result<Bvh, BuildError> {
    let instances = place_instances(geometries)?;
    let mut references = reference::collect(geometries, &instances)?;
    let split = presplit::presplit(&references, geometries, options.split_budget);
    if references.len().max(split.len()) >= Child::MAX_BLOCKS {
        return Err(BuildError::TooManyPrimitives);
    }
    let (mut tree, cost) = top::build(&mut references, options);
    // Splits help some scenes and harm others: in rooms with large slanted walls the pieces swell
    // so many nodes that rays took a third longer. The heuristic can tell beforehand.
    if !split.is_empty() {
        let mut split = split;
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
    let bounds = tree.first().map_or(Bounds3::EMPTY, BinaryNode::bounds);
    // Memory is at its peak below.
    drop(tree);
    let names = Names::new(geometries).ok_or(BuildError::TooManyPrimitives)?;
    let blocks = wide.fill_blocks(&references, geometries, &names);
    Ok(Bvh::from_parts(
        wide.nodes,
        (blocks, names),
        (wide.custom, instances),
        bounds,
        triangle_count,
    ))
}

/// The instances in the order of the geometries.
fn place_instances(geometries: &[GeometryView<'_>]) -> Result<Vec<Instance>, BuildError> {
    let is_instance = |view: &&GeometryView<'_>| matches!(view, GeometryView::Instance { .. });
    let count = geometries.iter().filter(is_instance).count();
    let mut instances = Vec::with_capacity(count);
    for (number, view) in geometries.iter().enumerate() {
        let GeometryView::Instance { group, to_world } = view else { continue };
        let geometry = u32::try_from(number).map_err(|_| BuildError::TooManyPrimitives)?;
        if !group.instances.is_empty() {
            return Err(BuildError::NestedInstance { geometry });
        }
        let instance = Instance::new(group.clone(), geometry, *to_world)
            .ok_or(BuildError::SingularTransform { geometry })?;
        instances.push(instance);
    }
    Ok(instances)
}
