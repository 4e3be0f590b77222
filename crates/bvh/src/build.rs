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

use crate::bvh::Bvh;
use crate::error::BuildError;
use crate::geometry::GeometryView;
use crate::instance::Instance;
use crate::node::Child;
use crate::options::BuildOptions;
use crate::triangle_numbers::TriangleNumbers;
use etendue_math::Bounds3;
use glam::Affine3A;
use std::sync::Arc;

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
    check_instances(geometries)?;
    let mut references = reference::collect(geometries)?;
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
    let bounds = tree.root().map_or(Bounds3::EMPTY, |root| tree.node(root).bounds());
    // Memory is at its peak below.
    drop(tree);
    let names = TriangleNumbers::new(geometries).ok_or(BuildError::TooManyPrimitives)?;
    let blocks = wide.fill_blocks(&references, geometries, &names);
    drop(references);
    // Only now: a million of them beside the tree would be a sixth of all memory.
    let mut instances = Vec::with_capacity(count_instances(geometries));
    for instance in place_instances(geometries) {
        instances.push(instance?);
    }
    Ok(Bvh::from_parts(
        wide.nodes,
        (blocks, names),
        (wide.custom, instances),
        bounds,
        triangle_count,
    ))
}

/// The instances in the order of the geometries.
fn place_instances(
    geometries: &[GeometryView<'_>],
) -> impl Iterator<Item = Result<Instance, BuildError>> {
    geometries.iter().enumerate().filter_map(|(number, view)| {
        let GeometryView::Instance { group, to_world } = view else { return None };
        Some(place_instance(number, group, *to_world))
    })
}

fn place_instance(
    number: usize,
    group: &Arc<Bvh>,
    to_world: Affine3A,
) -> Result<Instance, BuildError> {
    let geometry = u32::try_from(number).map_err(|_| BuildError::TooManyPrimitives)?;
    if !group.instances.is_empty() {
        return Err(BuildError::NestedInstance { geometry });
    }
    let instance = Instance::new(group.clone(), geometry, to_world);
    instance.ok_or(BuildError::SingularTransform { geometry })
}

/// Finds the first instance that cannot be.
fn check_instances(geometries: &[GeometryView<'_>]) -> Result<(), BuildError> {
    place_instances(geometries).try_for_each(|instance| instance.map(drop))
}

fn count_instances(geometries: &[GeometryView<'_>]) -> usize {
    let is_instance = |view: &&GeometryView<'_>| matches!(view, GeometryView::Instance { .. });
    geometries.iter().filter(is_instance).count()
}
