//! The traversal of a packet.

use super::rays::Packet;
use crate::bvh::Bvh;
use crate::node::{Child, TriangleBlock, WIDTH};
use crate::simd::wide::{MAX_LANES, Row, Wide};
use std::mem::MaybeUninit;

/// What the rays of a packet are traced for.
pub(super) trait Query<W: Wide> {
    /// Whether near children are visited first.
    const SORTED: bool;

    /// The greatest distances that count; negative for rays that are finished.
    fn limit(&self) -> W::Vector;

    /// The given rays meet a block.
    fn block(&mut self, rays: &Packet<W>, lanes: u32, block: &TriangleBlock);

    /// The given rays meet a child that packets cannot test.
    fn trace_singly(&mut self, lanes: u32, child: Child);
}

/// The lanes of a set.
pub(super) fn lanes_of(lanes: u32) -> impl Iterator<Item = usize> {
    (0..MAX_LANES).filter(move |lane| lanes >> lane & 1 != 0)
}

/// Below this level, rays are traced singly. Few trees are deeper, and a stack for the deepest
/// possible tree would touch more pages than small batches of rays are worth. (Small in tests, so
/// that they reach it.)
const DEPTH: usize = if cfg!(test) { 2 } else { 24 };
/// The pending children, by level and slot: those of one level all belong to one node.
struct Levels {
    /// The distances where the rays enter.
    enter: [[MaybeUninit<Row>; WIDTH]; DEPTH],
    /// The rays that enter, and the child.
    met: [[MaybeUninit<(u32, Child)>; WIDTH]; DEPTH],
}

/// A pending child: the distance where one of the rays enters it, then its level and slot. The bits
/// of non-negative floats sort like the floats.
type Entry = u64;

#[inline(always)]
fn entry(distance: f32, level: usize, slot: usize) -> Entry {
    u64::from(distance.to_bits()) << 32 | (level * WIDTH + slot) as u64
}

/// Traces the rays of `lanes` through the tree.
///
/// Tried and slower: tracing the last one to three active rays singly from where they are (primary
/// rays lost 5 %, bounced ones in the Cornell box a sixth); sorting batches by direction octants
/// (the sorting costs as much as it gains).
#[inline(always)]
pub(super) fn walk<W: Wide, Q: Query<W>>(bvh: &Bvh, rays: &Packet<W>, lanes: u32, query: &mut Q) {
    let mut levels = Levels {
        enter: [[const { MaybeUninit::uninit() }; WIDTH]; DEPTH],
        met: [[const { MaybeUninit::uninit() }; WIDTH]; DEPTH],
    };
    let mut stack = [MaybeUninit::<Entry>::uninit(); DEPTH * WIDTH];
    let nodes = bvh.nodes.as_ptr();
    let mut stack_len = 0;
    let (mut current, mut lanes, mut depth) = (Child::node(0), lanes, 0);
    loop {
        if current.is_node() && depth < DEPTH {
            // SAFETY: the builder numbers only nodes that exist.
            let node = unsafe { &*nodes.byte_add(current.node_offset()) };
            let (enters, mets) = (&mut levels.enter[depth], &mut levels.met[depth]);
            let bottom = stack_len;
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
                let mut place = stack_len;
                // SAFETY: entries below `stack_len` have been written, and each level has at most
                // eight.
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
                stack_len += 1;
            }
        } else if current.is_block() {
            // SAFETY: the builder numbers only blocks that exist.
            query.block(rays, lanes, unsafe { current.block_of(&bvh.blocks) });
        } else {
            query.trace_singly(lanes, current);
        }
        loop {
            if stack_len == 0 {
                return;
            }
            stack_len -= 1;
            // SAFETY: entries below `stack_len` have been written, and so have the levels that they
            // refer to: a level is overwritten only when none of its children is pending.
            let (child, met, level) = unsafe {
                let place = stack.get_unchecked(stack_len).assume_init() as u32 as usize;
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
