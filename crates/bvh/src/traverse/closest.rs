//! The nearest hit.

use super::STACK_SIZE;
use super::ray::{BoxConstants, RayConstants};
use crate::bvh::{Bvh, Hit};
use crate::geometry::Primitives;
use crate::node::{Child, ChildKind, Custom, TriangleBlock, WIDTH};
use crate::simd::Simd;
use crate::triangle::{BlockHits, intersect_block};
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
struct Nearest {
    /// The distance; hits count up to it, inclusive. `hit.t` is the same, if there is a hit.
    t_max: f32,
    /// The hit, except that `u` and `v` are yet to be divided by the determinant.
    hit: Hit,
    determinant: f32,
}

impl Nearest {
    /// The `geometry` while there is none.
    const NOTHING: u32 = u32::MAX;

    #[inline(always)]
    fn new(t_max: f32, instance: u32) -> Self {
        let nothing = Self::NOTHING;
        let hit = Hit { t: 0.0, u: 0.0, v: 0.0, geometry: nothing, primitive: nothing, instance };
        // Distances are below the ray's own end, and up to that of a hit.
        let t_max = f32::from_bits(t_max.to_bits() - 1);
        Self { t_max, hit, determinant: 1.0 }
    }

    /// Takes a hit that is nearer, or as near and of a lower number.
    #[inline(always)]
    fn offer(&mut self, hit: Hit, determinant: f32) {
        let rank = |hit: &Hit| (hit.instance, hit.geometry, hit.primitive);
        if hit.t < self.t_max
            || (hit.t == self.t_max
                && (self.hit.geometry == Self::NOTHING || rank(&hit) < rank(&self.hit)))
        {
            self.t_max = hit.t;
            self.hit = hit;
            self.determinant = determinant;
        }
    }

    #[inline(always)]
    fn finish(self) -> Option<Hit> {
        let Self { hit, determinant, .. } = self;
        (hit.geometry != Self::NOTHING).then(|| Hit {
            u: hit.u / determinant,
            v: hit.v / determinant,
            ..hit
        })
    }
}

/// The traversal, in one piece: with the ordering of children and the stack in functions of their
/// own, all inlined, the compiler chose other branches and rays were a twentieth slower.
///
/// One child that is met and two are by far the most common, and have ways of their own. Tried and
/// slower: ways without branches (the chain of dependent instructions grows by more than the wrong
/// guesses cost; any-hit rays by a fifth), passing over four waiting entries at a time, prefetching
/// what waits (no difference), other weights of nodes against blocks (no difference).
#[inline(always)]
pub(super) fn closest<S: Simd, P: Primitives>(
    bvh: &Bvh,
    ray: &Ray,
    primitives: &P,
    instance: u32,
) -> Option<Hit> {
    let constants = RayConstants::new(ray)?;
    let boxes = BoxConstants::<S>::new(ray, &constants);
    let mut nearest = Nearest::new(ray.t_max, instance);
    let mut stack = [MaybeUninit::<Entry>::uninit(); STACK_SIZE];
    let mut waiting = 0;
    let mut current = Child::node(0);
    loop {
        if current.is_node() {
            // SAFETY: the builder made as many nodes as it numbered.
            let node = unsafe { bvh.nodes.get_unchecked(current.0 as usize) };
            let (mut mask, enter) = boxes.meet(node, S::splat(nearest.t_max));
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
                // SAFETY: the depth of the hierarchy keeps `waiting` below STACK_SIZE.
                unsafe { stack.get_unchecked_mut(waiting) }.write(a.max(b));
                waiting += 1;
                let mut next = a.min(b);
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
        } else {
            match current.kind() {
                ChildKind::Block(index) => {
                    // SAFETY: the builder made as many blocks as it numbered.
                    let block = unsafe { bvh.blocks.get_unchecked(index) };
                    let found = intersect_block::<S>(block, &constants, nearest.t_max);
                    if let Some(candidates) = found
                        && let Some(hits) = candidates.hits(nearest.t_max)
                    {
                        offer_block(&mut nearest, block, &hits, instance);
                    }
                }
                ChildKind::Custom { first, count } => {
                    intersect_custom(
                        (bvh, primitives),
                        &bvh.custom[first..first + count],
                        ray,
                        instance,
                        &mut nearest,
                    );
                }
                ChildKind::Node(_) => {}
            }
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

/// Offers every lane that was hit.
#[inline(always)]
fn offer_block(nearest: &mut Nearest, block: &TriangleBlock, hits: &BlockHits, instance: u32) {
    let mut mask = hits.mask;
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize & (WIDTH - 1);
        mask &= mask - 1;
        let hit = Hit {
            t: hits.t.0[lane],
            u: hits.v.0[lane],
            v: hits.w.0[lane],
            geometry: block.geometry[lane],
            primitive: block.primitive[lane],
            instance,
        };
        nearest.offer(hit, hits.determinant.0[lane]);
    }
}

/// User primitives and instances, out of the way of the triangles.
#[inline(never)]
fn intersect_custom<P: Primitives>(
    (bvh, primitives): (&Bvh, &P),
    entries: &[Custom],
    ray: &Ray,
    instance: u32,
    nearest: &mut Nearest,
) {
    for &entry in entries {
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
            nearest.offer(hit, 1.0);
        }
    }
}
