//! Closest-hit traversal.

use super::ray::{BoxConstants, RayConstants};
use crate::bvh::Bvh;
use crate::depth::STACK_SIZE;
use crate::geometry::Primitives;
use crate::hit::Hit;
use crate::node::{Child, ChildKind, Custom, F32x8, TriangleBlock, WIDTH};
use crate::simd::Simd;
use crate::triangle::{Candidates, Resolved, intersect_block};
use crate::triangle_ids::TriangleIds;
use etendue_math::Ray;
use std::mem::MaybeUninit;
use std::ops::Range;

/// A pending child: the distance at which the ray enters its box, then the child. The bits of
/// non-negative floats sort like the floats, so entries compare as integers.
type Entry = u64;

#[inline(always)]
fn entry(distance: f32, child: Child) -> Entry {
    u64::from(distance.to_bits()) << 32 | u64::from(child.0)
}

/// The greatest entry that is not culled at this distance.
#[inline(always)]
fn limit(distance: f32) -> Entry {
    u64::from(distance.to_bits()) << 32 | u64::from(u32::MAX)
}

/// The hot part of the nearest hit so far. Every function that takes a reference to it is inlined,
/// so that it stays in registers.
struct Nearest<'a> {
    /// The distance; hits up to and including it count.
    t_max: f32,
    /// The greatest stack entry that is not culled.
    limit: Entry,
    /// The block of the triangle that is hit, if any, and its lane.
    block: Option<&'a TriangleBlock>,
    lane: usize,
}

/// The cold part of the nearest hit, in memory.
struct Details<'a> {
    /// The edge functions of the last block that was hit, and their sums, in all lanes: storing
    /// whole registers is cheaper than extracting a lane.
    v: F32x8,
    w: F32x8,
    determinant: F32x8,
    /// The hit of a user primitive or instance; valid if no block is hit.
    custom: Option<Hit>,
    instance: u32,
    ids: &'a TriangleIds,
}

impl<'a> Details<'a> {
    #[inline(always)]
    fn new(instance: u32, ids: &'a TriangleIds) -> Self {
        let zeros = F32x8([0.0; WIDTH]);
        Self { v: zeros, w: zeros, determinant: zeros, custom: None, instance, ids }
    }

    /// Whether a triangle takes precedence over the current hit at the same distance, which is a
    /// lane of `block` or else a custom primitive.
    #[cold]
    #[inline(never)]
    fn loses_tie_to(&self, id: u32, block: Option<&TriangleBlock>, lane: usize) -> bool {
        match (block, &self.custom) {
            (Some(old), _) => id < old.ids[lane],
            (None, Some(hit)) => self.rank_of(id) < hit.rank(),
            (None, None) => true,
        }
    }

    /// As `loses_tie_to`, for a custom primitive.
    #[cold]
    #[inline(never)]
    fn loses_tie_to_custom(&self, hit: &Hit, block: Option<&TriangleBlock>, lane: usize) -> bool {
        match (block, &self.custom) {
            (Some(old), _) => hit.rank() < self.rank_of(old.ids[lane]),
            (None, Some(old)) => hit.rank() < old.rank(),
            (None, None) => true,
        }
    }

    fn rank_of(&self, id: u32) -> (u32, u32, u32) {
        let (geometry, primitive) = self.ids.resolve(id);
        (self.instance, geometry, primitive)
    }
}

/// The lane with the lowest triangle id.
#[cold]
#[inline(never)]
fn lane_of_lowest_id(block: &TriangleBlock, lanes: u32) -> usize {
    let lanes = (0..WIDTH).filter(|lane| lanes >> lane & 1 != 0);
    lanes.min_by_key(|&lane| block.ids[lane]).unwrap_or(0)
}

impl<'a> Nearest<'a> {
    #[inline(always)]
    fn new(t_max: f32) -> Self {
        // The ray's end is exclusive, the distance of a hit inclusive.
        let t_max = f32::from_bits(t_max.to_bits() - 1);
        Self { t_max, limit: limit(t_max), block: None, lane: 0 }
    }

    #[inline(always)]
    fn set(&mut self, t: f32, block: Option<&'a TriangleBlock>, lane: usize) {
        *self = Self { t_max: t, limit: limit(t), block, lane };
    }

    /// Takes the nearest of the lanes that are hit, all of them within `t_max`.
    ///
    /// Without branches on how many lanes are hit or which is nearest: every second time it is more
    /// than one, and mispredictions made random rays a sixth slower.
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        details: &mut Details<'a>,
        block: &'a TriangleBlock,
        candidates: &Candidates<S>,
    ) {
        let t = S::reduce_min(candidates.t);
        let lanes = S::bitmask(S::less_equal(candidates.t, S::splat(t)));
        let lane = if lanes.is_power_of_two() {
            lanes.trailing_zeros() as usize
        } else {
            lane_of_lowest_id(block, lanes)
        };
        let lane = lane & (WIDTH - 1);
        if t < self.t_max || details.loses_tie_to(block.ids[lane], self.block, self.lane) {
            self.set(t, Some(block), lane);
            details.v = S::store(candidates.v);
            details.w = S::store(candidates.w);
            details.determinant = S::store(candidates.determinant);
        }
    }

    /// As [`Nearest::take`], for lanes that needed double precision.
    #[inline(always)]
    fn take_resolved(
        &mut self,
        details: &mut Details<'a>,
        block: &'a TriangleBlock,
        resolved: &Resolved,
    ) {
        for lane in (0..WIDTH).filter(|lane| resolved.mask >> lane & 1 != 0) {
            let t = resolved.t.0[lane];
            if t < self.t_max
                || (t == self.t_max && details.loses_tie_to(block.ids[lane], self.block, self.lane))
            {
                self.set(t, Some(block), lane);
                (details.v, details.w) = (resolved.v, resolved.w);
                details.determinant = F32x8([1.0; WIDTH]);
            }
        }
    }

    /// Takes the hit of a user primitive or instance if it is nearer, or equally near with a lower
    /// rank.
    #[inline(always)]
    fn offer(&mut self, details: &mut Details<'a>, hit: Hit) {
        if hit.t < self.t_max
            || (hit.t == self.t_max && details.loses_tie_to_custom(&hit, self.block, self.lane))
        {
            self.set(hit.t, None, 0);
            details.custom = Some(hit);
        }
    }

    #[inline(always)]
    fn finish(&self, details: &Details<'a>) -> Option<Hit> {
        let Some(block) = self.block else { return details.custom };
        let lane = self.lane & (WIDTH - 1);
        let (geometry, primitive) = details.ids.resolve(block.ids[lane]);
        Some(Hit {
            t: self.t_max,
            u: details.v.0[lane] / details.determinant.0[lane],
            v: details.w.0[lane] / details.determinant.0[lane],
            geometry,
            primitive,
            instance: details.instance,
        })
    }
}

/// The nearest hit below `start`. One long function: with the child ordering and the stack in
/// inlined functions of their own, the compiler chose different branches and rays were 5 % slower.
///
/// Nodes of which the ray meets one or two children are by far the most common, and have fast
/// paths. Tried and slower: branch-free paths (the dependency chain grows by more than the
/// mispredictions cost), a fixed order of the children for each direction octant, which needs no
/// sorting (10 % more nodes are visited), culling four pending entries at a time or one of two
/// without a branch, one path for two and three children (7 % slower). No difference: prefetching
/// pending entries, other weights of nodes against blocks.
///
/// What helped: nothing of [`Nearest`] in memory, pending entries compared as integers, no sheared
/// vertices kept for the lanes that single precision cannot decide, and a branch-free search for
/// the nearest lane of a block.
#[inline(always)]
pub(super) fn closest<S: Simd, P: Primitives>(
    bvh: &Bvh,
    ray: &Ray,
    primitives: &P,
    instance: u32,
    start: Child,
) -> Option<Hit> {
    let constants = RayConstants::new(ray)?;
    let boxes = BoxConstants::<S>::new(ray, &constants, &bvh.nodes);
    let mut nearest = Nearest::new(ray.t_max);
    let mut details = Details::new(instance, &bvh.triangle_ids);
    let mut stack = [MaybeUninit::<Entry>::uninit(); STACK_SIZE];
    // The lowest entry is never culled; it ends the traversal.
    stack[0].write(entry(0.0, Child::END));
    let nodes = bvh.nodes.as_ptr();
    let mut stack_len = 1;
    let mut current = start;
    loop {
        if current.is_node() {
            let offset = current.node_offset();
            // SAFETY: the builder numbers only nodes that exist.
            let (node, (mut mask, enter)) = unsafe {
                (&*nodes.byte_add(offset), boxes.intersect(offset, S::splat(nearest.t_max)))
            };
            if mask != 0 {
                let first = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                if mask == 0 {
                    current = node.children[first & (WIDTH - 1)];
                    continue;
                }
                let enter = S::store(enter);
                let key = |slot: usize| {
                    let slot = slot & (WIDTH - 1);
                    entry(enter.0[slot], node.children[slot])
                };
                let (a, b) = (key(first), key(mask.trailing_zeros() as usize));
                mask &= mask - 1;
                if mask == 0 {
                    // SAFETY: the depth of the hierarchy keeps `stack_len` below STACK_SIZE.
                    unsafe { stack.get_unchecked_mut(stack_len) }.write(a.max(b));
                    stack_len += 1;
                    current = Child(a.min(b) as u32);
                    continue;
                }
                let bottom = stack_len;
                let c = key(mask.trailing_zeros() as usize);
                mask &= mask - 1;
                let (low, high) = (a.min(b), a.max(b));
                let (middle, far) = (high.min(c), high.max(c));
                let mut next = low.min(middle);
                // SAFETY: the depth of the hierarchy keeps `stack_len` below STACK_SIZE.
                unsafe {
                    stack.get_unchecked_mut(stack_len).write(far);
                    stack.get_unchecked_mut(stack_len + 1).write(low.max(middle));
                }
                stack_len += 2;
                while mask != 0 {
                    let other = key(mask.trailing_zeros() as usize);
                    mask &= mask - 1;
                    let far = next.max(other);
                    next = next.min(other);
                    // Insertion sort among the children of this node, nearest on top.
                    let mut place = stack_len;
                    // SAFETY: entries below `stack_len` have been written, and the depth of the
                    // hierarchy keeps `stack_len` below STACK_SIZE.
                    unsafe {
                        while place > bottom && stack.get_unchecked(place - 1).assume_init() < far {
                            *stack.get_unchecked_mut(place) = *stack.get_unchecked(place - 1);
                            place -= 1;
                        }
                        stack.get_unchecked_mut(place).write(far);
                    }
                    stack_len += 1;
                }
                current = Child(next as u32);
                continue;
            }
        } else if current.is_block() {
            // SAFETY: the builder numbers only blocks that exist.
            let block = unsafe { current.block_of(&bvh.blocks) };
            if let Some(candidates) = intersect_block::<S>(block, &constants, nearest.t_max) {
                if candidates.mask != 0 {
                    nearest.take(&mut details, block, &candidates);
                }
                if candidates.uncertain != 0 {
                    let resolved = candidates.resolve(block, &constants, nearest.t_max);
                    nearest.take_resolved(&mut details, block, &resolved);
                }
            }
        } else if current == Child::END {
            return nearest.finish(&details);
        } else {
            for index in custom_entries(current) {
                let of = (bvh, primitives);
                let hit = intersect_custom(of, index, ray, instance, nearest.t_max);
                if let Some(hit) = hit {
                    nearest.offer(&mut details, hit);
                }
            }
        }
        loop {
            stack_len -= 1;
            // SAFETY: entries below `stack_len` have been written, and the lowest is never culled.
            let entry = unsafe { stack.get_unchecked(stack_len).assume_init() };
            if entry <= nearest.limit {
                current = Child(entry as u32);
                break;
            }
        }
    }
}

/// The custom entries of a leaf.
#[inline(always)]
fn custom_entries(child: Child) -> Range<usize> {
    match child.kind() {
        ChildKind::Custom { first, count } => first..first + count,
        _ => 0..0,
    }
}

/// Tests a user primitive or instance. Out of line, to keep the triangle path small.
#[inline(never)]
fn intersect_custom<P: Primitives>(
    (bvh, primitives): (&Bvh, &P),
    index: usize,
    ray: &Ray,
    instance: u32,
    t_max: f32,
) -> Option<Hit> {
    // One step beyond the nearest hit, to include hits at the same distance.
    let limited = Ray { t_max: t_max.next_up(), ..*ray };
    let hit = match bvh.custom[index] {
        Custom::User { geometry, primitive } => {
            let hit = if instance == Hit::NO_INSTANCE {
                primitives.intersect(geometry, primitive, &limited)
            } else {
                primitives.intersect_in(instance, geometry, primitive, &limited)
            };
            hit.map(|hit| {
                let (t, u, v) = (hit.t, hit.u, hit.v);
                Hit { t, u, v, geometry, primitive, instance }
            })
        }
        Custom::Instance { index } => {
            let placed = &bvh.instances[index as usize];
            let local = placed.to_local(&limited);
            placed.group.intersect_as(&local, primitives, placed.geometry)
        }
    };
    hit.filter(|hit| hit.t > 0.0 && hit.t <= t_max)
}
