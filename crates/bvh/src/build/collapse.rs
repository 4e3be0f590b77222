//! From the binary tree to wide nodes and blocks of triangles, at least cost.
//!
//! Every binary node knows what it costs to represent its references by at most 1, 2, …, 8 wide
//! children; a wide node then takes the best eight. Dynamic programming as by Ylitie, Karras and
//! Laine, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs* (HPG 2017),
//! section 3.1.

use super::binned::BinaryNode;
use super::reference::Reference;
use super::top::{Place, Tree};
use crate::error_bounds::padded;
use crate::geometry::GeometryView;
use crate::memory::{concatenate, vector_with_capacity};
use crate::node::{Child, Custom, Lengths, Node, TriangleBlock, WIDTH};
use crate::triangle_numbers::TriangleNumbers;
use rayon::prelude::*;

/// What a subtree costs as at most 1, 2, … 7 children of a wide node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Costs([f32; WIDTH - 1]);

/// How to reach the costs: for each number of children from two, how many go to the left side
/// (0: one child fewer is as good), three bits each; then whether a single child is a leaf.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plan(u32);

impl Plan {
    const LEAF: u32 = 1 << 31;

    fn left_share(self, children: usize) -> usize {
        (self.0 >> (3 * (children - 2)) & 7) as usize
    }

    pub(super) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }
}

impl Costs {
    /// A subtree that is one leaf.
    pub(super) fn leaf(area: f32) -> Self {
        Self([area; WIDTH - 1])
    }

    /// What the subtree costs as one child.
    pub(super) fn single(&self) -> f32 {
        self.0[0]
    }

    /// A subtree of two. `counts` are all references below it, and the custom ones.
    pub(super) fn combine(
        [left, right]: [&Self; 2],
        area: f32,
        node_cost: f32,
        (count, custom_count): (usize, usize),
    ) -> (Self, Plan) {
        let mut plan = 0;
        let mut distributed = [f32::INFINITY; WIDTH + 1];
        for children in 2..=WIDTH {
            let mut best = (0, distributed[children - 1]);
            for to_left in 1..children {
                let cost = left.0[to_left - 1] + right.0[children - to_left - 1];
                if cost < best.1 {
                    best = (to_left, cost);
                }
            }
            distributed[children] = best.1;
            plan |= (best.0 as u32) << (3 * (children - 2));
        }
        let as_node = area * node_cost + distributed[WIDTH];
        let can_be_leaf = match custom_count {
            0 => count <= WIDTH,
            custom => custom == count && count <= Child::MAX_CUSTOM,
        };
        let single = if can_be_leaf && area <= as_node {
            plan |= Plan::LEAF;
            area
        } else {
            as_node
        };
        let mut costs = [single; WIDTH - 1];
        for children in 2..WIDTH {
            if distributed[children] < costs[children - 2] {
                costs[children - 1] = distributed[children];
            } else {
                costs[children - 1] = costs[children - 2];
                plan &= !(7 << (3 * (children - 2)));
            }
        }
        (Self(costs), Plan(plan))
    }
}

/// Wide nodes, and which references each block of triangles takes.
#[derive(Default)]
pub(super) struct Wide {
    pub(super) nodes: Vec<Node>,
    pub(super) custom: Vec<Custom>,
    pub(super) triangle_count: usize,
    block_ranges: Vec<(u32, u32)>,
}

/// The binary nodes that become the children of a wide one; in place, as there are so many.
#[derive(Default)]
struct Children {
    /// With the number that they are ordered by.
    places: [(u64, Place); WIDTH],
    count: usize,
}

impl Children {
    fn push(&mut self, tree: &Tree, place: Place) {
        let node = tree.node(place);
        let area = node.bounds().half_area().to_bits();
        self.places[self.count] = (u64::from(node.is_leaf()) << 32 | u64::from(area), place);
        self.count += 1;
    }

    /// A ray that any hit will do for takes the last first: blocks, which end it soonest, and of them
    /// the largest. Segments then visit a sixth fewer nodes than in no order; by area alone, or with
    /// the smallest last, they visit more.
    fn sorted(&mut self) -> &[(u64, Place)] {
        let places = &mut self.places[..self.count];
        places.sort_by_key(|&(order, _)| order);
        places
    }
}

/// A slot of a wide node whose child is still to be added: a node inside a part.
struct Deferred {
    node: usize,
    slot: usize,
    place: Place,
}

/// So many deferred nodes are one task for a thread. They are a few thousand in a large tree.
const DEFERRED_PER_TASK: usize = 64;

/// Converts the tree: first the top, and then what is inside the parts, by several threads.
pub(super) fn collapse(tree: &Tree, references: &[Reference]) -> Wide {
    let mut top = Wide::default();
    let mut deferred = Vec::new();
    match tree.root() {
        None => top.nodes.push(Node::EMPTY),
        Some(root) if tree.node(root).is_leaf() => {
            top.nodes.push(Node::EMPTY);
            let node = tree.node(root);
            let child = top.add_leaf(node, references);
            top.nodes[0].set(0, padded(node.bounds()), child);
        }
        Some(root) => {
            top.add_node(tree, root, references, &mut deferred);
        }
    }
    let pieces: Vec<(Wide, Vec<Child>)> = deferred
        .par_chunks(DEFERRED_PER_TASK)
        .map(|deferred| {
            let mut piece = Wide::default();
            // Inside a part nothing more is deferred.
            let mut none = Vec::new();
            let add = |one: &Deferred| piece.add_node(tree, one.place, references, &mut none);
            let roots = deferred.iter().map(add).collect();
            (piece, roots)
        })
        .collect();
    let mut end = top.lengths();
    let mut placed = Vec::with_capacity(1 + pieces.len());
    for (deferred, (piece, roots)) in deferred.chunks(DEFERRED_PER_TASK).zip(pieces) {
        for (one, root) in deferred.iter().zip(roots) {
            top.nodes[one.node].children[one.slot] = root.moved(&end);
        }
        let lengths = piece.lengths();
        placed.push((piece, end));
        end = end.plus(lengths);
    }
    placed.insert(0, (top, Lengths::default()));
    Wide::join(&placed)
}

impl Wide {
    fn lengths(&self) -> Lengths {
        Lengths {
            nodes: self.nodes.len(),
            blocks: self.block_ranges.len(),
            custom: self.custom.len(),
        }
    }

    /// All in one, each moved behind those before it.
    fn join(pieces: &[(Self, Lengths)]) -> Self {
        Self {
            nodes: concatenate(
                pieces,
                0,
                |(piece, _)| piece.nodes.len(),
                |(piece, by)| piece.nodes.iter().map(|node| node.moved(by)),
            ),
            custom: pieces.iter().flat_map(|(piece, _)| &piece.custom).copied().collect(),
            triangle_count: pieces.iter().map(|(piece, _)| piece.triangle_count).sum(),
            block_ranges: pieces
                .iter()
                .flat_map(|(piece, _)| &piece.block_ranges)
                .copied()
                .collect(),
        }
    }

    /// Adds the wide node of a binary node and everything below, but for what is inside a part where
    /// the node itself is not. The recursion is as deep as the tree, which is bounded.
    fn add_node(
        &mut self,
        tree: &Tree,
        binary: Place,
        references: &[Reference],
        deferred: &mut Vec<Deferred>,
    ) -> Child {
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let mut children = Children::default();
        distribute(tree, binary, WIDTH, &mut children);
        // Where areas overflow or vanish no plan is better than none, and the node would be its own
        // child.
        if children.count == 1 {
            children = Children::default();
            tree.children(binary).into_iter().for_each(|child| children.push(tree, child));
        }
        for (slot, &(_, place)) in children.sorted().iter().enumerate() {
            let node = tree.node(place);
            let child = if node.is_leaf() {
                self.add_leaf(node, references)
            } else if binary.is_top() && !place.is_top() {
                deferred.push(Deferred { node: index, slot, place });
                Child::EMPTY
            } else {
                self.add_node(tree, place, references, deferred)
            };
            self.nodes[index].set(slot, padded(node.bounds()), child);
        }
        Child::node(index)
    }

    fn add_leaf(&mut self, node: &BinaryNode, references: &[Reference]) -> Child {
        let range = node.first as usize..(node.first + node.count) as usize;
        if !references[range.start].is_custom() {
            self.block_ranges.push((node.first, node.count));
            self.triangle_count += node.count as usize;
            return Child::block(self.block_ranges.len() - 1);
        }
        let child = Child::custom(self.custom.len(), node.count as usize);
        self.custom.extend(references[range].iter().map(|reference| {
            let (geometry, primitive) = (reference.geometry(), reference.primitive());
            if reference.is_instance() {
                Custom::Instance { index: primitive }
            } else {
                Custom::User { geometry, primitive }
            }
        }));
        child
    }

    /// Copies the triangles into their blocks.
    pub(super) fn fill_blocks(
        &self,
        references: &[Reference],
        geometries: &[GeometryView<'_>],
        names: &TriangleNumbers,
    ) -> Vec<TriangleBlock> {
        let mut blocks = vector_with_capacity(self.block_ranges.len());
        self.block_ranges
            .par_iter()
            .map(|&(first, count)| {
                let references = &references[first as usize..(first + count) as usize];
                fill_block(references, geometries, names)
            })
            .collect_into_vec(&mut blocks);
        blocks
    }
}

/// Gathers the subtrees that become at most `children` children.
fn distribute(tree: &Tree, binary: Place, children: usize, into: &mut Children) {
    let node = tree.node(binary);
    let mut children = children;
    while children > 1 && node.plan.left_share(children) == 0 {
        children -= 1;
    }
    if children == 1 || node.right == 0 {
        into.push(tree, binary);
        return;
    }
    let to_left = node.plan.left_share(children);
    let [left, right] = tree.children(binary);
    distribute(tree, left, to_left, into);
    distribute(tree, right, children - to_left, into);
}

fn fill_block(
    references: &[Reference],
    geometries: &[GeometryView<'_>],
    names: &TriangleNumbers,
) -> TriangleBlock {
    let mut block = TriangleBlock::EMPTY;
    let mut count = 0;
    for reference in references {
        let (geometry, primitive) = (reference.geometry(), reference.primitive());
        let name = names.name(geometry, primitive);
        // Parts of one triangle may meet again.
        if block.names[..count].contains(&name) {
            continue;
        }
        if let GeometryView::Triangles(mesh) = &geometries[geometry as usize] {
            let corners =
                mesh.indices[primitive as usize].map(|index| mesh.positions[index as usize]);
            block.set(count, name, corners);
            count += 1;
        }
    }
    let [a, b] = [0, 1].map(|vertex| block.vertex(vertex, 0));
    for lane in count..WIDTH {
        block.set(lane, block.names[0], [a, b, a]);
    }
    block
}
