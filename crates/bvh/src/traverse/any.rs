//! Any-hit traversal.

use super::ray::{BoxConstants, RayConstants};
use crate::bvh::Bvh;
use crate::depth::STACK_SIZE;
use crate::geometry::Primitives;
use crate::hit::Hit;
use crate::node::{Child, ChildKind, Custom, WIDTH};
use crate::simd::Simd;
use crate::triangle::intersect_block;
use etendue_math::Ray;
use std::mem::MaybeUninit;

/// Whether the ray hits anything below `start`.
///
/// If two or more children are met, they are pushed without a branch on their number, which is
/// unpredictable for incoherent rays: this spared those rays a third of their mispredictions. The
/// cases of none and one keep their branches: for coherent rays, prediction lets the processor run
/// ahead of the box test (shadow rays were a quarter slower without).
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
    // The ray's end is exclusive, the limit of the test inclusive.
    let t_max = f32::from_bits(ray.t_max.to_bits() - 1);
    let t_max_lanes = S::splat(t_max);
    let mut stack = [MaybeUninit::<u32>::uninit(); STACK_SIZE];
    let stack = stack.as_mut_ptr().cast::<u32>();
    // SAFETY: the stack has room for one entry.
    unsafe { stack.write(Child::END.0) };
    let nodes = bvh.nodes.as_ptr();
    let mut stack_len = 1;
    let mut current = start;
    loop {
        if current.is_node() {
            let offset = current.node_offset();
            // SAFETY: the builder numbers only nodes that exist.
            let (node, (mask, _)) =
                unsafe { (&*nodes.byte_add(offset), boxes.intersect(offset, t_max_lanes)) };
            if mask.is_power_of_two() {
                current = node.children[mask.trailing_zeros() as usize & (WIDTH - 1)];
                continue;
            }
            if mask != 0 {
                // SAFETY: the depth of the hierarchy keeps `stack_len` eight below STACK_SIZE.
                unsafe { S::compress(node.words(), mask, stack.add(stack_len)) };
                current = node.children[mask.ilog2() as usize & (WIDTH - 1)];
                stack_len = stack_len + mask.count_ones() as usize - 1;
                continue;
            }
        } else {
            let hit = if current.is_block() {
                // SAFETY: the builder numbers only blocks that exist.
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
        stack_len -= 1;
        // SAFETY: entries below `stack_len` have been written, and the lowest ends the traversal.
        current = Child(unsafe { *stack.add(stack_len) });
    }
}

/// Tests user primitives and instances. Out of line, to keep the triangle path small.
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
        Custom::User { geometry, primitive } if instance == Hit::NO_INSTANCE => {
            primitives.occludes(geometry, primitive, ray)
        }
        Custom::User { geometry, primitive } => {
            primitives.occludes_in(instance, geometry, primitive, ray)
        }
        Custom::Instance { index } => {
            let placed = &bvh.instances[index as usize];
            placed.group.occluded_as(&placed.to_local(ray), primitives, placed.geometry)
        }
    })
}
