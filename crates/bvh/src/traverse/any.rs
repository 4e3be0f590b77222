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

/// The traversal of what is below a child. Children that are met are pushed without a branch on how many there are, unless
/// it is one: nothing foretells their number for rays in any direction. That spared those rays a
/// third of their wrong guesses, but where rays resemble each other the guess lets the processor
/// run ahead of the box test, and so the cases of none and one keep their branches (shadow rays
/// were a quarter slower without).
#[inline(always)]
pub(super) fn any<S: Simd, P: Primitives>(
    bvh: &Bvh,
    ray: &Ray,
    primitives: &P,
    instance: u32,
    start: Child,
) -> bool {
    let Some(constants) = RayConstants::new(ray) else { return false };
    let boxes = BoxConstants::<S>::new(ray, &constants, &bvh.nodes);
    // Hits count below the ray's end, and the test counts them up to its own.
    let t_max = f32::from_bits(ray.t_max.to_bits() - 1);
    let t_max_lanes = S::splat(t_max);
    let mut stack = [MaybeUninit::<u32>::uninit(); STACK_SIZE];
    let stack = stack.as_mut_ptr().cast::<u32>();
    // SAFETY: the stack has room for one.
    unsafe { stack.write(Child::END.0) };
    let nodes = bvh.nodes.as_ptr();
    let mut waiting = 1;
    let mut current = start;
    loop {
        if current.is_node() {
            let offset = current.node_offset();
            // SAFETY: the builder made as many nodes as it numbered.
            let (node, (mask, _)) =
                unsafe { (&*nodes.byte_add(offset), boxes.meet(offset, t_max_lanes)) };
            if mask.is_power_of_two() {
                current = node.children[mask.trailing_zeros() as usize & (WIDTH - 1)];
                continue;
            }
            if mask != 0 {
                // SAFETY: the depth of the hierarchy keeps `waiting` eight below STACK_SIZE.
                unsafe { S::compress(node.words(), mask, stack.add(waiting)) };
                current = node.children[mask.ilog2() as usize & (WIDTH - 1)];
                waiting = waiting + mask.count_ones() as usize - 1;
                continue;
            }
        } else {
            let hit = if current.is_block() {
                // SAFETY: the builder made as many blocks as it numbered.
                let block = unsafe { current.block_of(&bvh.blocks) };
                intersect_block::<S>(block, &constants, t_max)
                    .is_some_and(|candidates| candidates.any(block, &constants, t_max))
            } else if current == Child::END {
                return false;
            } else {
                occludes_custom(bvh, primitives, current, ray, instance)
            };
            if hit {
                return true;
            }
        }
        waiting -= 1;
        // SAFETY: entries below `waiting` have been written, and the lowest ends the traversal.
        current = Child(unsafe { *stack.add(waiting) });
    }
}

/// User primitives and instances, out of the way of the triangles.
#[inline(never)]
fn occludes_custom<P: Primitives>(
    bvh: &Bvh,
    primitives: &P,
    child: Child,
    ray: &Ray,
    instance: u32,
) -> bool {
    let ChildKind::Custom { first, count } = child.kind() else { return false };
    bvh.custom[first..first + count].iter().any(|&entry| match entry {
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
