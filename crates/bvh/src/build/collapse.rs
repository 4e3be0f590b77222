//! Converts the binary tree into wide nodes and blocks of triangles, following the plan of least
//! cost (see `plan`).

use super::binary_tree::{BinaryNode, Place, Tree};
use super::reference::Reference;
use crate::error_bounds::padded;
use crate::geometry::GeometryView;
use crate::memory::{concatenate, vector_with_capacity};
use crate::node::{Child, Custom, Lengths, Node, TriangleBlock, WIDTH};
use crate::triangle_ids::TriangleIds;
use rayon::prelude::*;

/// Wide nodes, and the range of references in each block of triangles.
#[derive(Default)]
pub(super) struct Wide {
    pub(super) nodes: Vec<Node>,
    pub(super) custom: Vec<Custom>,
    pub(super) triangle_count: usize,
    block_ranges: Vec<(u32, u32)>,
}

/// The binary nodes that become the children of a wide node. In place, because there are many.
#[derive(Default)]
struct Children {
    /// Each with its sort key.
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

    /// An any-hit query visits the last child first: blocks, which end it soonest, and the largest
    /// of them. This way segments visit a sixth fewer nodes than in arbitrary order. By area alone,
    /// or with the smallest last, they visit more.
    fn sorted(&mut self) -> &[(u64, Place)] {
        let places = &mut self.places[..self.count];
        places.sort_by_key(|&(order, _)| order);
        places
    }
}

/// A slot of a wide node whose child, a node inside a part, is yet to be added.
struct Deferred {
    node: usize,
    slot: usize,
    place: Place,
}

/// The number of deferred nodes per parallel task. A large tree has a few thousand of them.
const DEFERRED_PER_TASK: usize = 64;

/// Converts the tree: first the top, then the inside of the parts, in parallel.
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

    /// Concatenates the pieces, and moves the references of each behind those before it.
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

    /// Adds the wide node of a binary node and everything below it. Children inside a part are
    /// deferred if the node itself is in the top. The recursion is as deep as the tree, whose depth
    /// is bounded.
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
        // If areas overflow or vanish, the plan may be to keep the node as a single child, which
        // would make it its own child.
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
        ids: &TriangleIds,
    ) -> Vec<TriangleBlock> {
        let mut blocks = vector_with_capacity(self.block_ranges.len());
        self.block_ranges
            .par_iter()
            .map(|&(first, count)| {
                let references = &references[first as usize..(first + count) as usize];
                fill_block(references, geometries, ids)
            })
            .collect_into_vec(&mut blocks);
        blocks
    }
}

/// Collects the subtrees that become at most `children` children.
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
    ids: &TriangleIds,
) -> TriangleBlock {
    let mut block = TriangleBlock::EMPTY;
    let mut count = 0;
    for reference in references {
        let (geometry, primitive) = (reference.geometry(), reference.primitive());
        let id = ids.id(geometry, primitive);
        // The parts of a split triangle may end up in the same block.
        if block.ids[..count].contains(&id) {
            continue;
        }
        if let GeometryView::Triangles(mesh) = &geometries[geometry as usize] {
            let corners =
                mesh.indices[primitive as usize].map(|index| mesh.positions[index as usize]);
            block.set(count, id, corners);
            count += 1;
        }
    }
    let [a, b] = [0, 1].map(|vertex| block.vertex(vertex, 0));
    for lane in count..WIDTH {
        block.set(lane, block.ids[0], [a, b, a]);
    }
    block
}
