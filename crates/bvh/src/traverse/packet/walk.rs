//! The way of a packet through the tree.

use super::rays::Packet;
use crate::bvh::Bvh;
use crate::node::{Child, TriangleBlock, WIDTH};
use crate::simd::wide::{Row, Wide};
use std::mem::MaybeUninit;

/// What the rays of a packet are traced for.
pub(super) trait Query<W: Wide> {
    /// Whether near children come first.
    const SORTED: bool;

    /// The greatest distances that count; below zero for rays that look for nothing more.
    fn limit(&self) -> W::Vector;

    /// Some rays meet a block.
    fn block(&mut self, rays: &Packet<W>, lanes: u32, block: &TriangleBlock);

    /// Some rays meet a child that packets have no test for.
    fn alone(&mut self, lanes: u32, child: Child);
}

/// Below so many levels of nodes rays go on alone. Few trees are deeper, and a stack for the deepest
/// that there can be would take more pages than small batches of rays are worth. (Tests want trees that are deeper.)
const DEPTH: usize = if cfg!(test) { 2 } else { 24 };

/// What waits, by level and slot: children that wait on a level all belong to one node.
struct Levels {
    /// Where the rays enter.
    enter: [[MaybeUninit<Row>; WIDTH]; DEPTH],
    /// Which rays do, and the child.
    met: [[MaybeUninit<(u32, Child)>; WIDTH]; DEPTH],
}

/// A child that waits: the distance where some ray enters it, then its level and slot. The bits of
/// numbers that are not negative are ordered as the numbers.
type Entry = u64;

#[inline(always)]
fn entry(distance: f32, level: usize, slot: usize) -> Entry {
    u64::from(distance.to_bits()) << 32 | (level * WIDTH + slot) as u64
}

/// Takes the rays of `lanes` through the tree.
///
/// Tried and slower: rays that are left alone or in a group of two or three go on one by one from
/// where they are (primary rays lost a twentieth, bounced ones on the Cornell box a sixth); sorting
/// batches by the octants of their directions (the sorting costs what it gains).
#[inline(always)]
pub(super) fn walk<W: Wide, Q: Query<W>>(bvh: &Bvh, rays: &Packet<W>, lanes: u32, query: &mut Q) {
    let mut levels = Levels {
        enter: [[const { MaybeUninit::uninit() }; WIDTH]; DEPTH],
        met: [[const { MaybeUninit::uninit() }; WIDTH]; DEPTH],
    };
    let mut stack = [MaybeUninit::<Entry>::uninit(); DEPTH * WIDTH];
    let nodes = bvh.nodes.as_ptr();
    let mut waiting = 0;
    let (mut current, mut lanes, mut depth) = (Child::node(0), lanes, 0);
    loop {
        if current.is_node() && depth < DEPTH {
            // SAFETY: the builder made as many nodes as it numbered.
            let node = unsafe { &*nodes.byte_add(current.node_offset()) };
            let (enters, mets) = (&mut levels.enter[depth], &mut levels.met[depth]);
            let bottom = waiting;
            let limit = query.limit();
            for slot in 0..WIDTH {
                let child = node.children[slot];
                if child == Child::EMPTY {
                    break;
                }
                let (met, enter) = rays.meet(node, slot, limit);
                let met = met & lanes;
                if met == 0 {
                    continue;
                }
                mets[slot].write((met, child));
                let enter = enters[slot].write(W::store(enter));
                let distance = enter.0[met.trailing_zeros() as usize & (W::LANES - 1)];
                let new = entry(distance, depth, slot);
                let mut place = waiting;
                // SAFETY: entries below `waiting` have been written, and no more wait than eight on
                // each level.
                unsafe {
                    while Q::SORTED
                        && place > bottom
                        && stack.get_unchecked(place - 1).assume_init() < new
                    {
                        *stack.get_unchecked_mut(place) = *stack.get_unchecked(place - 1);
                        place -= 1;
                    }
                    stack.get_unchecked_mut(place).write(new);
                }
                waiting += 1;
            }
        } else if current.is_block() {
            // SAFETY: the builder made as many blocks as it numbered.
            query.block(rays, lanes, unsafe { current.block_of(&bvh.blocks) });
        } else {
            query.alone(lanes, current);
        }
        loop {
            if waiting == 0 {
                return;
            }
            waiting -= 1;
            // SAFETY: entries below `waiting` have been written, and where they point to, too: a
            // level changes only when none of its children wait.
            let (child, met, level) = unsafe {
                let place = stack.get_unchecked(waiting).assume_init() as u32 as usize;
                let (level, slot) = (place / WIDTH, place % WIDTH);
                let enter = levels.enter.get_unchecked(level)[slot].assume_init_ref();
                let (met, child) = levels.met.get_unchecked(level)[slot].assume_init();
                (child, met & W::less_equal(W::load(enter), query.limit()), level)
            };
            if met != 0 {
                (current, lanes, depth) = (child, met, level + 1);
                break;
            }
        }
    }
}
