//! The binary tree.

use super::extent::Box4;
use super::plan::Plan;
use etendue_math::Bounds3;
use glam::Vec3;

/// A node of the binary tree. Its left child follows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode {
    min: Vec3,
    max: Vec3,
    /// The index of the first reference below it; for a leaf of the top, the index of the part.
    pub(super) first: u32,
    /// The number of references below it; zero in the top, where they may not be contiguous.
    pub(super) count: u32,
    /// The offset of its right child from this node; 0 for a leaf.
    pub(super) right: u32,
    /// The best conversion into wide nodes.
    pub(super) plan: Plan,
}

impl BinaryNode {
    /// A leaf; set `right` and `plan` to make it an inner node.
    pub(super) fn new(bounds: &Box4, first: usize, count: usize) -> Self {
        Self {
            min: bounds.min.truncate(),
            max: -bounds.negated_max.truncate(),
            first: first as u32,
            count: count as u32,
            right: 0,
            plan: Plan::default(),
        }
    }

    pub(super) fn bounds(&self) -> Bounds3 {
        Bounds3::new(self.min, self.max)
    }

    pub(super) fn is_leaf(&self) -> bool {
        self.right == 0 || self.plan.is_leaf()
    }
}

/// The binary tree: the tree of the top, whose leaves stand for parts, and the tree of each part.
#[derive(Default)]
pub(super) struct Tree {
    pub(super) top: Vec<BinaryNode>,
    pub(super) parts: Vec<Vec<BinaryNode>>,
}

/// The position of a node in the tree.
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
    /// The root, if there are any references.
    pub(super) fn root(&self) -> Option<Place> {
        (!self.top.is_empty()).then(|| self.enter(Place { part: Place::TOP, index: 0 }))
    }

    pub(super) fn node(&self, place: Place) -> &BinaryNode {
        let nodes = if place.is_top() { &self.top } else { &self.parts[place.part as usize] };
        &nodes[place.index as usize]
    }

    /// The children of an inner node.
    pub(super) fn children(&self, place: Place) -> [Place; 2] {
        let right = place.index + self.node(place).right;
        [place.index + 1, right].map(|index| self.enter(Place { index, ..place }))
    }

    /// Replaces a leaf of the top by the root of the part that it stands for.
    fn enter(&self, place: Place) -> Place {
        let node = self.node(place);
        if place.is_top() && node.right == 0 { Place { part: node.first, index: 0 } } else { place }
    }
}
