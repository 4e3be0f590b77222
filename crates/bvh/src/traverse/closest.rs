//! The nearest hit.

use super::STACK_SIZE;
use super::ray::{BoxConstants, RayConstants};
use crate::bvh::{Bvh, Hit};
use crate::geometry::Primitives;
use crate::node::{Child, ChildKind, Custom, F32x8, TriangleBlock, WIDTH};
use crate::simd::Simd;
use crate::triangle::{Candidates, Resolved, intersect_block};
use crate::triangle_numbers::TriangleNumbers;
use etendue_math::Ray;
use std::mem::MaybeUninit;
use std::ops::Range;

/// A child that waits: the distance where the ray enters its box, and the child. The bits of
/// numbers that are not negative are ordered as the numbers, so entries compare as integers.
type Entry = u64;

#[inline(always)]
fn entry(distance: f32, child: Child) -> Entry {
    u64::from(distance.to_bits()) << 32 | u64::from(child.0)
}

/// The greatest entry that a distance does not pass over.
#[inline(always)]
fn limit(distance: f32) -> Entry {
    u64::from(distance.to_bits()) << 32 | u64::from(u32::MAX)
}

/// The nearest hit so far, as far as the traversal needs it all the time. Everything that takes a
/// reference to it is inlined, so that it stays in registers.
struct Nearest<'a> {
    /// The distance; hits count up to it, inclusive.
    t_max: f32,
    /// The greatest entry of the stack that counts.
    limit: Entry,
    /// The triangle that is hit, if any, by its block and lane.
    block: Option<&'a TriangleBlock>,
    lane: usize,
}

/// The rest of the nearest hit, in memory.
struct Details<'a> {
    /// What triangles are hit with: the edge functions and their sum, of all lanes of the block,
    /// because storing registers is cheaper than picking from them. Only the last block's count.
    v: F32x8,
    w: F32x8,
    determinant: F32x8,
    /// What a user primitive or an instance reported; counts where no block is hit.
    custom: Option<Hit>,
    instance: u32,
    names: &'a TriangleNumbers,
}

impl<'a> Details<'a> {
    #[inline(always)]
    fn new(instance: u32, names: &'a TriangleNumbers) -> Self {
        let none = F32x8([0.0; WIDTH]);
        Self { v: none, w: none, determinant: none, custom: None, instance, names }
    }

    /// Whether the triangle of this name counts, and not what was hit as far away before, in the
    /// lane of a block or else a custom primitive.
    #[cold]
    #[inline(never)]
    fn yields_to(&self, name: u32, block: Option<&TriangleBlock>, lane: usize) -> bool {
        match (block, &self.custom) {
            (Some(old), _) => name < old.names[lane],
            (None, Some(hit)) => self.rank_of(name) < rank(hit),
            (None, None) => true,
        }
    }

    /// As `yields_to`, of a custom primitive.
    #[cold]
    #[inline(never)]
    fn yields_to_custom(&self, hit: &Hit, block: Option<&TriangleBlock>, lane: usize) -> bool {
        match (block, &self.custom) {
            (Some(old), _) => rank(hit) < self.rank_of(old.names[lane]),
            (None, Some(old)) => rank(hit) < rank(old),
            (None, None) => true,
        }
    }

    fn rank_of(&self, name: u32) -> (u32, u32, u32) {
        let (geometry, primitive) = self.names.resolve(name);
        (self.instance, geometry, primitive)
    }
}

/// The lane of the lowest name.
#[cold]
#[inline(never)]
fn lowest_name(block: &TriangleBlock, lanes: u32) -> usize {
    let lanes = (0..WIDTH).filter(|lane| lanes >> lane & 1 != 0);
    lanes.min_by_key(|&lane| block.names[lane]).unwrap_or(0)
}

/// Of hits that are equally far that of the lowest rank counts.
fn rank(hit: &Hit) -> (u32, u32, u32) {
    (hit.instance, hit.geometry, hit.primitive)
}

impl<'a> Nearest<'a> {
    #[inline(always)]
    fn new(t_max: f32) -> Self {
        // Distances are below the ray's own end, and up to that of a hit.
        let t_max = f32::from_bits(t_max.to_bits() - 1);
        Self { t_max, limit: limit(t_max), block: None, lane: 0 }
    }

    #[inline(always)]
    fn set(&mut self, t: f32, block: Option<&'a TriangleBlock>, lane: usize) {
        *self = Self { t_max: t, limit: limit(t), block, lane };
    }

    /// Takes the nearest of the lanes that were hit, all of them within `t_max`. Without a branch on
    /// how many they are or which is nearer, which cannot be foretold: every second time it is more
    /// than one, and random rays were a sixth slower with branches.
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        details: &mut Details<'a>,
        block: &'a TriangleBlock,
        candidates: &Candidates<S>,
    ) {
        let t = S::least_lane(candidates.t);
        let lanes = S::bits(S::less_equal(candidates.t, S::splat(t)));
        let lane = if lanes.is_power_of_two() {
            lanes.trailing_zeros() as usize
        } else {
            lowest_name(block, lanes)
        };
        let lane = lane & (WIDTH - 1);
        if t < self.t_max || details.yields_to(block.names[lane], self.block, self.lane) {
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
                || (t == self.t_max && details.yields_to(block.names[lane], self.block, self.lane))
            {
                self.set(t, Some(block), lane);
                (details.v, details.w) = (resolved.v, resolved.w);
                details.determinant = F32x8([1.0; WIDTH]);
            }
        }
    }

    /// Takes what a user primitive or an instance reported, if it is nearer, or as near and of a
    /// lower number.
    #[inline(always)]
    fn offer(&mut self, details: &mut Details<'a>, hit: Hit) {
        if hit.t < self.t_max
            || (hit.t == self.t_max && details.yields_to_custom(&hit, self.block, self.lane))
        {
            self.set(hit.t, None, 0);
            details.custom = Some(hit);
        }
    }

    #[inline(always)]
    fn finish(&self, details: &Details<'a>) -> Option<Hit> {
        let Some(block) = self.block else { return details.custom };
        let lane = self.lane & (WIDTH - 1);
        let (geometry, primitive) = details.names.resolve(block.names[lane]);
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

/// The traversal of what is below a child, in one piece: with the ordering of children and the stack in functions of their
/// own, all inlined, the compiler chose other branches and rays were a twentieth slower.
///
/// One child that is met and two are by far the most common, and have ways of their own. Tried and
/// slower: ways without branches (the chain of dependent instructions grows by more than the wrong
/// guesses cost), a fixed order of the children for each octant of directions, which needs no
/// sorting (a tenth more nodes are visited), passing over four waiting entries at a time or over one
/// of two without a branch, one way for two children and three (a fifteenth slower), prefetching what
/// waits (no difference), other weights of nodes against blocks (no difference).
/// What gained: nothing of [`Nearest`] in memory, waiting entries compared as integers, no sheared
/// vertices kept for the lanes that single precision leaves open, and the nearest lane of a block
/// found without a branch.
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
    let mut details = Details::new(instance, &bvh.names);
    let mut stack = [MaybeUninit::<Entry>::uninit(); STACK_SIZE];
    // Nothing passes over the lowest entry, which ends the traversal.
    stack[0].write(entry(0.0, Child::END));
    let nodes = bvh.nodes.as_ptr();
    let mut waiting = 1;
    let mut current = start;
    loop {
        if current.is_node() {
            let offset = current.node_offset();
            // SAFETY: the builder made as many nodes as it numbered.
            let (node, (mut mask, enter)) =
                unsafe { (&*nodes.byte_add(offset), boxes.meet(offset, S::splat(nearest.t_max))) };
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
                    // SAFETY: the depth of the hierarchy keeps `waiting` below STACK_SIZE.
                    unsafe { stack.get_unchecked_mut(waiting) }.write(a.max(b));
                    waiting += 1;
                    current = Child(a.min(b) as u32);
                    continue;
                }
                let bottom = waiting;
                let c = key(mask.trailing_zeros() as usize);
                mask &= mask - 1;
                let (low, high) = (a.min(b), a.max(b));
                let (middle, far) = (high.min(c), high.max(c));
                let mut next = low.min(middle);
                // SAFETY: the depth of the hierarchy keeps `waiting` below STACK_SIZE.
                unsafe {
                    stack.get_unchecked_mut(waiting).write(far);
                    stack.get_unchecked_mut(waiting + 1).write(low.max(middle));
                }
                waiting += 2;
                while mask != 0 {
                    let other = key(mask.trailing_zeros() as usize);
                    mask &= mask - 1;
                    let far = next.max(other);
                    next = next.min(other);
                    // Insert among the children of this node, nearest on top.
                    let mut place = waiting;
                    // SAFETY: entries below `waiting` have been written, and the depth of the
                    // hierarchy keeps `waiting` below STACK_SIZE.
                    unsafe {
                        while place > bottom && stack.get_unchecked(place - 1).assume_init() < far {
                            *stack.get_unchecked_mut(place) = *stack.get_unchecked(place - 1);
                            place -= 1;
                        }
                        stack.get_unchecked_mut(place).write(far);
                    }
                    waiting += 1;
                }
                current = Child(next as u32);
                continue;
            }
        } else if current.is_block() {
            // SAFETY: the builder made as many blocks as it numbered.
            let block = unsafe { current.block_of(&bvh.blocks) };
            if let Some(candidates) = intersect_block::<S>(block, &constants, nearest.t_max) {
                if candidates.mask != 0 {
                    nearest.take(&mut details, block, &candidates);
                }
                if candidates.doubtful != 0 {
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
            waiting -= 1;
            // SAFETY: entries below `waiting` have been written, and the lowest is not passed over.
            let entry = unsafe { stack.get_unchecked(waiting).assume_init() };
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

/// A user primitive or an instance, out of the way of the triangles.
#[inline(never)]
fn intersect_custom<P: Primitives>(
    (bvh, primitives): (&Bvh, &P),
    index: usize,
    ray: &Ray,
    instance: u32,
    t_max: f32,
) -> Option<Hit> {
    // One step beyond the nearest hit, for the hits that are as near.
    let limited = Ray { t_max: t_max.next_up(), ..*ray };
    let hit = match bvh.custom[index] {
        Custom::User { geometry, primitive } => {
            let hit = if instance == u32::MAX {
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
            super::intersect(&placed.group, &local, primitives, placed.geometry)
        }
    };
    hit.filter(|hit| hit.t > 0.0 && hit.t <= t_max)
}
