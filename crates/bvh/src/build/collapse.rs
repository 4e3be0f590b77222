//! From the binary tree to wide nodes and blocks of triangles, at least cost.
//!
//! Every binary node knows what it costs to represent its references by at most 1, 2, …, 8 wide
//! children; a wide node then takes the best eight. Dynamic programming as by Ylitie, Karras and
//! Laine, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs* (HPG 2017),
//! section 3.1.

use super::binned::BinaryNode;
use super::reference::Reference;
use crate::error_bounds::padded;
use crate::geometry::GeometryView;
use crate::memory::vector_with_capacity;
use crate::names::Names;
use crate::node::{Child, Custom, Node, TriangleBlock, WIDTH};
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

    fn is_leaf(self) -> bool {
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
    places: [usize; WIDTH],
    count: usize,
}

impl Children {
    fn push(&mut self, place: usize) {
        self.places[self.count] = place;
        self.count += 1;
    }

    fn as_slice(&self) -> &[usize] {
        &self.places[..self.count]
    }

    fn as_mut_slice(&mut self) -> &mut [usize] {
        &mut self.places[..self.count]
    }
}

/// Converts the tree.
pub(super) fn collapse(tree: &[BinaryNode], references: &[Reference]) -> Wide {
    // Room for more than there will be: what is not used is never touched, and costs nothing.
    let mut wide = Wide {
        nodes: vector_with_capacity(tree.len() / 4 + 1),
        block_ranges: Vec::with_capacity(tree.len() / 2 + 1),
        ..Wide::default()
    };
    if let Some(root) = tree.first() {
        if is_leaf(root) {
            wide.nodes.push(Node::EMPTY);
            let child = wide.add_leaf(root, references);
            wide.nodes[0].set(0, padded(root.bounds()), child);
        } else {
            wide.add_node(tree, 0, references);
        }
    } else {
        wide.nodes.push(Node::EMPTY);
    }
    wide
}

fn is_leaf(node: &BinaryNode) -> bool {
    node.right == 0 || node.plan.is_leaf()
}

impl Wide {
    /// Adds the wide node of a binary node and everything below. The recursion is as deep as the
    /// tree, which is bounded.
    fn add_node(&mut self, tree: &[BinaryNode], binary: usize, references: &[Reference]) -> Child {
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let mut children = Children::default();
        distribute(tree, binary, WIDTH, &mut children);
        // Where areas overflow or vanish no plan is better than none, and the node would be its own
        // child.
        if children.as_slice() == [binary] {
            children = Children::default();
            children.push(binary + 1);
            children.push(binary + tree[binary].right as usize);
        }
        // A ray that any hit will do for takes the last first: blocks, which end it soonest, and of
        // them the largest. Segments then visit a sixth fewer nodes than in no order; by area alone,
        // or with the smallest last, they visit more.
        children.as_mut_slice().sort_by_key(|&child| {
            let node = &tree[child];
            (is_leaf(node), node.bounds().half_area().to_bits())
        });
        for (slot, &child) in children.as_slice().iter().enumerate() {
            let node = &tree[child];
            let word = if is_leaf(node) {
                self.add_leaf(node, references)
            } else {
                self.add_node(tree, child, references)
            };
            self.nodes[index].set(slot, padded(node.bounds()), word);
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
        names: &Names,
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
fn distribute(tree: &[BinaryNode], binary: usize, children: usize, into: &mut Children) {
    let node = &tree[binary];
    let mut children = children;
    while children > 1 && node.plan.left_share(children) == 0 {
        children -= 1;
    }
    if children == 1 || node.right == 0 {
        into.push(binary);
        return;
    }
    let to_left = node.plan.left_share(children);
    distribute(tree, binary + 1, to_left, into);
    distribute(tree, binary + node.right as usize, children - to_left, into);
}

fn fill_block(
    references: &[Reference],
    geometries: &[GeometryView<'_>],
    names: &Names,
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
