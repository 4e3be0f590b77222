//! The nodes of the top of the binary tree, while it is optimised.

use super::extent::Box4;

/// A node of the top.
#[derive(Clone, Copy)]
pub(super) struct TopNode {
    pub(super) bounds: Box4,
    /// [`TopNode::NONE`] for the root.
    pub(super) parent: u32,
    pub(super) below: Below,
}

/// The content of a node of the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Below {
    /// Two nodes of the top.
    Nodes([u32; 2]),
    /// One of its parts.
    Part(u32),
}

impl TopNode {
    pub(super) const NONE: u32 = u32::MAX;

    pub(super) fn new(bounds: Box4, below: Below) -> Self {
        Self { bounds, parent: Self::NONE, below }
    }

    pub(super) fn area(&self) -> f32 {
        self.bounds.half_area()
    }
}
