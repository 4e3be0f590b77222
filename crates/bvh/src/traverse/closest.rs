//! The nearest hit.

use super::STACK_SIZE;
use super::ray::{BoxConstants, RayConstants};
use crate::bvh::{Bvh, Hit};
use crate::geometry::Primitives;
use crate::names::Names;
use crate::node::{Child, ChildKind, Custom, Lanes, TriangleBlock, WIDTH};
use crate::simd::Simd;
use crate::triangle::{Candidates, Resolved, intersect_block};
use etendue_math::Ray;
use std::mem::MaybeUninit;

/// A child that waits: the distance where the ray enters its box, and the child. The bits of
/// numbers that are not negative are ordered as the numbers, so entries compare as integers.
type Entry = u64;

#[inline(always)]
fn entry(distance: f32, child: Child) -> Entry {
    u64::from(distance.to_bits()) << 32 | u64::from(child.0)
}

#[inline(always)]
fn distance(entry: Entry) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

/// The nearest hit so far.
struct Nearest<'a> {
    /// The distance; hits count up to it, inclusive.
    t_max: f32,
    /// What is hit.
    found: Found<'a>,
    /// What triangles are hit with: the edge functions and their sum, of all lanes of the block,
    /// because storing registers is cheaper than picking from them. Only the last block's count.
    v: Lanes,
    w: Lanes,
    determinant: Lanes,
    instance: u32,
    names: &'a Names,
}

/// What is hit.
#[derive(Clone, Copy)]
enum Found<'a> {
    Nothing,
    /// A triangle.
    Lane(&'a TriangleBlock, usize),
    /// What a user primitive or an instance reported, in `Nearest::custom`.
    Custom(Hit),
}

impl<'a> Nearest<'a> {
    #[inline(always)]
    fn new(t_max: f32, instance: u32, names: &'a Names) -> Self {
        let none = Lanes([0.0; WIDTH]);
        // Distances are below the ray's own end, and up to that of a hit.
        let t_max = f32::from_bits(t_max.to_bits() - 1);
        Self { t_max, found: Found::Nothing, v: none, w: none, determinant: none, instance, names }
    }

    /// Takes the nearest of the lanes that were hit, all of them within `t_max`.
    #[inline(always)]
    fn take<S: Simd>(&mut self, block: &'a TriangleBlock, candidates: &Candidates<S>) {
        let mask = candidates.mask;
        if mask != 0 {
            let t = S::store(candidates.t);
            let mut lane = mask.trailing_zeros() as usize & (WIDTH - 1);
            let mut rest = mask & (mask - 1);
            while rest != 0 {
                let other = rest.trailing_zeros() as usize & (WIDTH - 1);
                rest &= rest - 1;
                if t.0[other] < t.0[lane]
                    || (t.0[other] == t.0[lane] && block.names[other] < block.names[lane])
                {
                    lane = other;
                }
            }
            if t.0[lane] < self.t_max || self.yields_to(block, lane) {
                self.t_max = t.0[lane];
                self.found = Found::Lane(block, lane);
                self.v = S::store(candidates.v);
                self.w = S::store(candidates.w);
                self.determinant = S::store(candidates.determinant);
            }
        }
        if candidates.doubtful != 0 {
            self.take_resolved(block, &candidates.resolve(self.t_max));
        }
    }

    /// As [`Nearest::take`], for lanes that needed double precision.
    #[cold]
    #[inline(never)]
    fn take_resolved(&mut self, block: &'a TriangleBlock, resolved: &Resolved) {
        for lane in (0..WIDTH).filter(|lane| resolved.mask >> lane & 1 != 0) {
            let t = resolved.t.0[lane];
            if t < self.t_max || (t == self.t_max && self.yields_to(block, lane)) {
                self.t_max = t;
                self.found = Found::Lane(block, lane);
                (self.v, self.w) = (resolved.v, resolved.w);
                self.determinant = Lanes([1.0; WIDTH]);
            }
        }
    }

    /// Whether, of two hits that are equally far, that with this lane counts.
    #[cold]
    #[inline(never)]
    fn yields_to(&self, block: &TriangleBlock, lane: usize) -> bool {
        let name = block.names[lane];
        let (geometry, primitive) = self.names.resolve(name);
        match self.found {
            Found::Nothing => true,
            Found::Lane(block, lane) => name < block.names[lane],
            Found::Custom(hit) => {
                (self.instance, geometry, primitive) < (hit.instance, hit.geometry, hit.primitive)
            }
        }
    }

    /// Takes what a user primitive or an instance reported, if it is nearer, or as near and of a
    /// lower number.
    fn offer(&mut self, hit: Hit) {
        let rank_of = |hit: &Hit| (hit.instance, hit.geometry, hit.primitive);
        let is_first = || match self.found {
            Found::Nothing => true,
            Found::Lane(block, lane) => {
                let (geometry, primitive) = self.names.resolve(block.names[lane]);
                rank_of(&hit) < (self.instance, geometry, primitive)
            }
            Found::Custom(old) => rank_of(&hit) < rank_of(&old),
        };
        if hit.t < self.t_max || (hit.t == self.t_max && is_first()) {
            self.t_max = hit.t;
            self.found = Found::Custom(hit);
        }
    }

    #[inline(always)]
    fn finish(&self) -> Option<Hit> {
        match self.found {
            Found::Nothing => None,
            Found::Lane(block, lane) => {
                let lane = lane & (WIDTH - 1);
                let (geometry, primitive) = self.names.resolve(block.names[lane]);
                Some(Hit {
                    t: self.t_max,
                    u: self.v.0[lane] / self.determinant.0[lane],
                    v: self.w.0[lane] / self.determinant.0[lane],
                    geometry,
                    primitive,
                    instance: self.instance,
                })
            }
            Found::Custom(hit) => Some(hit),
        }
    }
}

/// The traversal, in one piece: with the ordering of children and the stack in functions of their
/// own, all inlined, the compiler chose other branches and rays were a twentieth slower.
///
/// One child that is met and two are by far the most common, and have ways of their own. Tried and
/// slower: ways without branches (the chain of dependent instructions grows by more than the wrong
/// guesses cost), a fixed order of the children for each octant of directions, which needs no
/// sorting (a tenth more nodes are visited), passing over four waiting entries at a time,
/// prefetching what waits (no difference), other weights of nodes against blocks (no difference).
#[inline(always)]
pub(super) fn closest<S: Simd, P: Primitives>(
    bvh: &Bvh,
    ray: &Ray,
    primitives: &P,
    instance: u32,
) -> Option<Hit> {
    let constants = RayConstants::new(ray)?;
    let boxes = BoxConstants::<S>::new(ray, &constants, &bvh.nodes);
    let mut nearest = Nearest::new(ray.t_max, instance, &bvh.names);
    let mut stack = [MaybeUninit::<Entry>::uninit(); STACK_SIZE];
    let nodes = bvh.nodes.as_ptr();
    let mut waiting = 0;
    let mut current = Child::node(0);
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
                nearest.take(block, &candidates);
            }
        } else {
            intersect_custom((bvh, primitives), current, ray, instance, &mut nearest);
        }
        loop {
            if waiting == 0 {
                return nearest.finish();
            }
            waiting -= 1;
            // SAFETY: entries below `waiting` have been written.
            let entry = unsafe { stack.get_unchecked(waiting).assume_init() };
            if distance(entry) <= nearest.t_max {
                current = Child(entry as u32);
                break;
            }
        }
    }
}

/// User primitives and instances, out of the way of the triangles.
#[inline(never)]
fn intersect_custom<P: Primitives>(
    (bvh, primitives): (&Bvh, &P),
    child: Child,
    ray: &Ray,
    instance: u32,
    nearest: &mut Nearest<'_>,
) {
    let ChildKind::Custom { first, count } = child.kind() else { return };
    for &entry in &bvh.custom[first..first + count] {
        // One step beyond the nearest hit, for the hits that are as near.
        let limited = Ray { t_max: nearest.t_max.next_up(), ..*ray };
        let hit = match entry {
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
        if let Some(hit) = hit
            && hit.t > 0.0
            && hit.t <= nearest.t_max
        {
            nearest.offer(hit);
        }
    }
}
