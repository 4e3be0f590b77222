//! Counts that describe a hierarchy.

use crate::Bvh;
use crate::node::{Child, ChildKind, WIDTH};

/// Counts that describe a hierarchy, and what a random ray costs in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Inner nodes.
    pub nodes: usize,
    /// Children per node, on average, of the 8 there could be.
    pub children_per_node: f32,
    /// Blocks of triangles.
    pub blocks: usize,
    /// Triangles in the blocks; spatial splits count a triangle more than once.
    pub triangle_references: usize,
    /// Triangles per block, on average, of the 8 there could be.
    pub triangles_per_block: f32,
    /// User primitives and instances.
    pub custom: usize,
    /// Nodes on the longest way from the root.
    pub depth: usize,
    /// How many nodes a random line through the bounds visits, on average.
    pub expected_nodes: f32,
    /// How many blocks a random line through the bounds visits, on average.
    pub expected_blocks: f32,
}

impl Statistics {
    pub(crate) fn of(bvh: &Bvh) -> Self {
        let whole = bvh.bounds.half_area().max(f32::MIN_POSITIVE);
        let (mut children, mut depth) = (0, 0);
        let (mut nodes_area, mut blocks_area) = (whole, 0.0);
        let mut waiting = vec![(0, 1)];
        while let Some((index, level)) = waiting.pop() {
            depth = depth.max(level);
            let node = &bvh.nodes[index];
            for slot in (0..WIDTH).filter(|&slot| node.children[slot] != Child::EMPTY) {
                children += 1;
                let area = node.bounds(slot).half_area();
                match node.children[slot].kind() {
                    ChildKind::Node(child) => {
                        nodes_area += area;
                        waiting.push((child, level + 1));
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
