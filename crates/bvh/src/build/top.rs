//! The binary tree: its top first, rearranged, and then the parts below.
//!
//! Splitting from the root down decides first where least is known. Around a large wall between
//! small things, say, the boxes of many levels swell: a third of the nodes that rays met were met
//! in vain. Rearranging the few thousand nodes at the top (`reinsert`) mends most of that: in a
//! room of a million triangles rays meet a quarter fewer nodes, and it takes a hundredth of the
//! build. What lies deeper is built afterwards, so that nothing is done twice.

use super::binned::{BinaryNode, Builder, PARALLEL, Task};
use super::collapse::Costs;
use super::extent::{Box4, Extent};
use super::reference::Reference;
use super::{MAX_TOP_DEPTH, reinsert};
use crate::node::WIDTH;
use crate::options::BuildOptions;
use rayon::prelude::*;

/// The top has no more parts than this, and no more than one for so many references.
const MAX_PARTS: usize = 4096;
const REFERENCES_PER_PART: usize = 32;

/// A node of the top.
#[derive(Clone, Copy)]
pub(super) struct TopNode {
    pub(super) bounds: Box4,
    /// [`TopNode::NONE`] for the root.
    pub(super) parent: u32,
    pub(super) below: Below,
}

/// What a node of the top consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Below {
    /// Two nodes of the top.
    Nodes([u32; 2]),
    /// One of its parts.
    Part(u32),
}

impl TopNode {
    pub(super) const NONE: u32 = u32::MAX;

    fn new(bounds: Box4, below: Below) -> Self {
        Self { bounds, parent: Self::NONE, below }
    }

    pub(super) fn area(&self) -> f32 {
        self.bounds.half_area()
    }
}

/// References that are not divided further in the top: how many, and their boxes.
struct Part {
    count: usize,
    extent: Extent,
}

/// The binary tree: that of the top, whose leaves stand for parts, and that of each part.
pub(super) struct Tree {
    top: Vec<BinaryNode>,
    parts: Vec<Vec<BinaryNode>>,
}

/// Where a node of the tree is.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Place {
    /// [`Place::TOP`] for nodes of the top.
    part: u32,
    index: u32,
}

impl Place {
    const TOP: u32 = u32::MAX;

    /// Whether the node is above all parts.
    pub(super) fn is_top(self) -> bool {
        self.part == Self::TOP
    }
}

impl Tree {
    /// Where the root is, if there are any references.
    pub(super) fn root(&self) -> Option<Place> {
        (!self.top.is_empty()).then(|| self.enter(Place { part: Place::TOP, index: 0 }))
    }

    pub(super) fn node(&self, place: Place) -> &BinaryNode {
        let nodes = if place.is_top() { &self.top } else { &self.parts[place.part as usize] };
        &nodes[place.index as usize]
    }

    /// Where the children of a node are that is no leaf.
    pub(super) fn children(&self, place: Place) -> [Place; 2] {
        let right = place.index + self.node(place).right;
        [place.index + 1, right].map(|index| self.enter(Place { index, ..place }))
    }

    /// The root of the part instead of the leaf of the top that stands for it.
    fn enter(&self, place: Place) -> Place {
        let node = self.node(place);
        if place.is_top() && node.right == 0 { Place { part: node.first, index: 0 } } else { place }
    }
}

/// The root comes first, and parts are in the order of their references.
#[derive(Default)]
struct Top {
    nodes: Vec<TopNode>,
    parts: Vec<Part>,
}

/// Builds the tree and orders the references of every part by its leaves. Also says what the tree
/// costs, in half areas times blocks.
pub(super) fn build(references: &mut [Reference], options: &BuildOptions) -> (Tree, f32) {
    if references.is_empty() {
        return (Tree { top: Vec::new(), parts: Vec::new() }, 0.0);
    }
    let builder = Builder::new(options);
    let extent = Extent::of_many(references);
    let reference_count = references.len();
    let mut top = Top::default();
    let part_count = (reference_count / REFERENCES_PER_PART).min(MAX_PARTS);
    let root = Task { references: &mut *references, first: 0, extent, depth: 0 };
    top.grow(&builder, root, part_count as f32);
    top.link_parents();
    let before = top.nodes.clone();
    reinsert::improve(&mut top.nodes, reference_count);
    let mut depths = top.depths();
    if depths.iter().any(|&depth| depth > MAX_TOP_DEPTH) {
        top.nodes = before;
        depths = top.depths();
    }
    let (parts, part_costs) = top.build_parts(&builder, references, &depths);
    let mut tree = Tree { top: Vec::with_capacity(top.nodes.len()), parts };
    let costs = top.emit(0, builder.node_cost, &part_costs, &mut tree.top);
    (tree, costs.single())
}

impl Top {
    /// Divides a task into at most `part_count` parts (one, if that is less than two), more of them
    /// where there is more surface. The recursion ends at the depth of the cost heuristic or before.
    fn grow(&mut self, builder: &Builder, task: Task<'_>, part_count: f32) {
        let (place, count, bounds) = (self.nodes.len(), task.references.len(), task.extent.bounds);
        // Ranges that may become one leaf are left whole.
        if part_count < 2.0 || count <= WIDTH || task.depth >= MAX_TOP_DEPTH {
            self.nodes.push(TopNode::new(bounds, Below::Part(self.parts.len() as u32)));
            self.parts.push(Part { count, extent: task.extent });
            return;
        }
        self.nodes.push(TopNode::new(bounds, Below::Nodes([0; 2])));
        let [left, right] = builder.divide(task);
        let [left_area, right_area] = [&left, &right].map(|side| side.extent.bounds.half_area());
        // Where the areas are no use, `max` turns the share to one.
        let share = part_count * (left_area / (left_area + right_area));
        let left_count = share.max(1.0).min(part_count - 1.0);
        let right_count = part_count - left_count;
        let right_place = if count > PARALLEL {
            let mut other = Self::default();
            rayon::join(
                || self.grow(builder, left, left_count),
                || other.grow(builder, right, right_count),
            );
            let right_place = self.nodes.len();
            self.append(other);
            right_place
        } else {
            self.grow(builder, left, left_count);
            let right_place = self.nodes.len();
            self.grow(builder, right, right_count);
            right_place
        };
        self.nodes[place].below = Below::Nodes([place as u32 + 1, right_place as u32]);
    }

    /// Takes over what was grown elsewhere, and numbers it anew.
    fn append(&mut self, other: Self) {
        let (first_node, first_part) = (self.nodes.len() as u32, self.parts.len() as u32);
        self.nodes.extend(other.nodes.into_iter().map(|node| TopNode {
            below: match node.below {
                Below::Nodes(children) => Below::Nodes(children.map(|child| child + first_node)),
                Below::Part(part) => Below::Part(part + first_part),
            },
            ..node
        }));
        self.parts.extend(other.parts);
    }

    fn link_parents(&mut self) {
        for index in 0..self.nodes.len() {
            if let Below::Nodes(children) = self.nodes[index].below {
                children.iter().for_each(|&child| self.nodes[child as usize].parent = index as u32);
            }
        }
    }

    /// How far from the root each part is.
    fn depths(&self) -> Vec<usize> {
        let mut depths = vec![0; self.parts.len()];
        let mut waiting = vec![(0, 0)];
        while let Some((node, depth)) = waiting.pop() {
            match self.nodes[node as usize].below {
                Below::Nodes(children) => waiting.extend(children.map(|child| (child, depth + 1))),
                Below::Part(part) => depths[part as usize] = depth,
            }
        }
        depths
    }

    /// Builds the tree of every part, and says what each costs.
    fn build_parts(
        &self,
        builder: &Builder,
        references: &mut [Reference],
        depths: &[usize],
    ) -> (Vec<Vec<BinaryNode>>, Vec<Costs>) {
        let mut first = 0;
        let mut rest = references;
        let mut tasks = Vec::with_capacity(self.parts.len());
        for (part, &depth) in self.parts.iter().zip(depths) {
            let (references, others) = rest.split_at_mut(part.count);
            tasks.push(Task { references, first, extent: part.extent, depth });
            (first, rest) = (first + part.count, others);
        }
        tasks
            .into_par_iter()
            // What comes of a part is copied from memory that is at hand: just as much as there is.
            .map_init(Vec::new, |nodes, task| {
                nodes.clear();
                let finished = builder.build(task, nodes);
                (nodes.clone(), finished.costs)
            })
            .unzip()
    }

    /// Appends a node and everything below it in the top. The recursion is at most
    /// [`MAX_TOP_DEPTH`] deep.
    fn emit(
        &self,
        index: u32,
        node_cost: f32,
        part_costs: &[Costs],
        tree: &mut Vec<BinaryNode>,
    ) -> Costs {
        let node = &self.nodes[index as usize];
        let place = tree.len();
        let [left, right] = match node.below {
            Below::Nodes(children) => children,
            Below::Part(part) => {
                tree.push(BinaryNode::new(&node.bounds, part as usize, 0));
                return part_costs[part as usize];
            }
        };
        tree.push(BinaryNode::new(&node.bounds, 0, 0));
        let left = self.emit(left, node_cost, part_costs, tree);
        let right_place = tree.len();
        let right = self.emit(right, node_cost, part_costs, tree);
        // More than any leaf holds: its references may lie apart.
        let counts = (usize::MAX, 0);
        let (costs, plan) = Costs::combine([&left, &right], node.area(), node_cost, counts);
        tree[place].right = (right_place - place) as u32;
        tree[place].plan = plan;
        costs
    }
}
