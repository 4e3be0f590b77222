//! Statistics of a hierarchy.

use crate::bvh::Bvh;
use crate::node::{Child, ChildKind, WIDTH};

/// Counts that describe a hierarchy, and the expected cost of a random ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Inner nodes.
    pub nodes: usize,
    /// The average number of children per node, out of 8.
    pub children_per_node: f32,
    /// Blocks of triangles.
    pub blocks: usize,
    /// Triangles in the blocks. Spatial splits count a triangle more than once.
    pub triangle_references: usize,
    /// The average number of triangles per block, out of 8.
    pub triangles_per_block: f32,
    /// User primitives and instances.
    pub custom: usize,
    /// The number of nodes on the longest path from the root.
    pub depth: usize,
    /// The expected number of nodes that a random line through the bounds visits.
    pub expected_nodes: f32,
    /// The expected number of blocks that a random line through the bounds visits.
    pub expected_blocks: f32,
}

impl Bvh {
    /// Counts that describe the hierarchy.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        Statistics::of(self)
    }
}

impl Statistics {
    fn of(bvh: &Bvh) -> Self {
        let whole = bvh.bounds.half_area().max(f32::MIN_POSITIVE);
        let (mut children, mut depth) = (0, 0);
        let (mut nodes_area, mut blocks_area) = (whole, 0.0);
        let mut stack = vec![(0, 1)];
        while let Some((index, level)) = stack.pop() {
            depth = depth.max(level);
            let node = &bvh.nodes[index];
            for slot in (0..WIDTH).filter(|&slot| node.children[slot] != Child::EMPTY) {
                children += 1;
                let area = node.bounds(slot).half_area();
                match node.children[slot].kind() {
                    ChildKind::Node(child) => {
                        nodes_area += area;
                        stack.push((child, level + 1));
                    }
                    ChildKind::Block(_) => blocks_area += area,
                    ChildKind::Custom { .. } => {}
                }
            }
        }
        Self {
            nodes: bvh.nodes.len(),
            children_per_node: children as f32 / bvh.nodes.len() as f32,
            blocks: bvh.blocks.len(),
            triangle_references: bvh.triangle_count,
            triangles_per_block: bvh.triangle_count as f32 / bvh.blocks.len().max(1) as f32,
            custom: bvh.custom.len(),
            depth,
            expected_nodes: nodes_area / whole,
            expected_blocks: blocks_area / whole,
        }
    }
}
