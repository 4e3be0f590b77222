//! Whether a ray hits anything.

use super::STACK_SIZE;
use super::ray::{BoxConstants, RayConstants};
use crate::bvh::Bvh;
use crate::geometry::Primitives;
use crate::node::{Child, ChildKind, Custom, WIDTH};
use crate::simd::Simd;
use crate::triangle::intersect_block;
use etendue_math::Ray;
use std::mem::MaybeUninit;

#[inline(always)]
pub(super) fn any<S: Simd, P: Primitives>(
    bvh: &Bvh,
    ray: &Ray,
    primitives: &P,
    instance: u32,
) -> bool {
    let Some(constants) = RayConstants::new(ray) else { return false };
    let boxes = BoxConstants::<S>::new(ray, &constants);
    // Hits count below the ray's end, and the test counts them up to its own.
    let t_max = f32::from_bits(ray.t_max.to_bits() - 1);
    let t_max_lanes = S::splat(t_max);
    let mut stack = [MaybeUninit::<Child>::uninit(); STACK_SIZE];
    let mut waiting = 0;
    let mut current = Child::node(0);
    loop {
        if current.is_node() {
            // SAFETY: the builder made as many nodes as it numbered.
            let node = unsafe { bvh.nodes.get_unchecked(current.0 as usize) };
            let (mut mask, _) = boxes.meet(node, t_max_lanes);
            while mask != 0 {
                let slot = mask.trailing_zeros() as usize & (WIDTH - 1);
                mask &= mask - 1;
                // SAFETY: the depth of the hierarchy keeps `waiting` below STACK_SIZE.
                unsafe { stack.get_unchecked_mut(waiting) }.write(node.children[slot]);
                waiting += 1;
            }
        } else {
            let hit = match current.kind() {
                ChildKind::Block(index) => {
                    // SAFETY: the builder made as many blocks as it numbered.
                    let block = unsafe { bvh.blocks.get_unchecked(index) };
                    intersect_block::<S>(block, &constants, t_max)
                        .is_some_and(|candidates| candidates.any(t_max))
                }
                ChildKind::Custom { first, count } => occludes_custom(
                    bvh,
                    primitives,
                    &bvh.custom[first..first + count],
                    ray,
                    instance,
                ),
                ChildKind::Node(_) => false,
            };
            if hit {
                return true;
            }
        }
        if waiting == 0 {
            return false;
        }
        waiting -= 1;
        // SAFETY: entries below `waiting` have been written.
        current = unsafe { stack.get_unchecked(waiting).assume_init() };
    }
}

/// User primitives and instances, out of the way of the triangles.
#[inline(never)]
fn occludes_custom<P: Primitives>(
    bvh: &Bvh,
    primitives: &P,
    entries: &[Custom],
    ray: &Ray,
    instance: u32,
) -> bool {
    entries.iter().any(|&entry| match entry {
        Custom::User { geometry, primitive } if instance == u32::MAX => {
            primitives.occludes(geometry, primitive, ray)
        }
        Custom::User { geometry, primitive } => {
            primitives.occludes_in(instance, geometry, primitive, ray)
        }
        Custom::Instance { index } => {
            let placed = &bvh.instances[index as usize];
            super::occluded(&placed.group, &placed.to_local(ray), primitives, placed.geometry)
        }
    })
}
