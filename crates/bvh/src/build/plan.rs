//! How to convert a binary tree into wide nodes at least cost.
//!
//! Every binary node stores the cost of representing its references by at most 1, 2, …, 7 wide
//! children; a wide node then takes the best eight. Dynamic programming as in Ylitie, Karras and
//! Laine, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs* (HPG 2017),
//! section 3.1.

use crate::node::{Child, WIDTH};

/// The cost of a subtree as at most 1, 2, … 7 children of a wide node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Costs([f32; WIDTH - 1]);

/// The choices behind [`Costs`]: for each number of children from two, how many of them go to the
/// left side (0 if one child fewer is as good), in three bits each; and whether the subtree is a
/// leaf if it is a single child.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plan(u32);

impl Plan {
    const LEAF: u32 = 1 << 31;

    /// How many of `children` go to the left side; 0 if one child fewer is as good.
    pub(super) fn left_share(self, children: usize) -> usize {
        (self.0 >> (3 * (children - 2)) & 7) as usize
    }

    pub(super) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }
}

impl Costs {
    /// The cost of a single leaf.
    pub(super) fn leaf(area: f32) -> Self {
        Self([area; WIDTH - 1])
    }

    /// The cost of the subtree as one child.
    pub(super) fn single(&self) -> f32 {
        self.0[0]
    }

    /// The cost of a subtree with two children, and the plan to reach it. The counts are those of
    /// all references below it, and of the custom ones.
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
