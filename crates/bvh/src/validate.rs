//! Structural checks of a finished hierarchy.

use crate::bvh::Bvh;
use crate::depth::MAX_DEPTH;
use crate::node::{Child, ChildKind, WIDTH};
use etendue_math::Bounds3;

impl Bvh {
    /// Checks the structure: every child is inside its parent's box, everything is reached exactly
    /// once, and the depth does not exceed the limit of the traversal.
    ///
    /// # Errors
    ///
    /// A description of the first flaw, which would be a defect of this crate.
    pub fn validate(&self) -> Result<(), String> {
        validate(self)
    }
}

fn validate(bvh: &Bvh) -> Result<(), String> {
    let mut reached = Reached {
        nodes: vec![false; bvh.nodes.len()],
        blocks: vec![false; bvh.blocks.len()],
        custom: vec![false; bvh.custom.len()],
    };
    let everything = Bounds3::new(glam::Vec3::NEG_INFINITY, glam::Vec3::INFINITY);
    let mut stack = vec![(0, everything, 1)];
    mark(&mut reached.nodes, 0, "node")?;
    while let Some((index, parent, depth)) = stack.pop() {
        if depth > MAX_DEPTH {
            return Err(format!("node {index} is deeper than {MAX_DEPTH}"));
        }
        let node = &bvh.nodes[index];
        for slot in (0..WIDTH).filter(|&slot| node.children[slot] != Child::EMPTY) {
            let bounds = node.bounds(slot);
            if !contains(&parent, &bounds) {
                return Err(format!("slot {slot} of node {index} extends outside its parent"));
            }
            match node.children[slot].kind() {
                ChildKind::Node(child) => {
                    mark(&mut reached.nodes, child, "node")?;
                    stack.push((child, bounds, depth + 1));
                }
                ChildKind::Block(block) => {
                    mark(&mut reached.blocks, block, "block")?;
                    check_block(bvh, block, &bounds)?;
                }
                ChildKind::Custom { first, count } => {
                    for entry in first..first + count {
                        mark(&mut reached.custom, entry, "custom entry")?;
                    }
                }
            }
        }
    }
    all(&reached.nodes, "node")?;
    all(&reached.blocks, "block")?;
    all(&reached.custom, "custom entry")
}

struct Reached {
    nodes: Vec<bool>,
    blocks: Vec<bool>,
    custom: Vec<bool>,
}

fn contains(outer: &Bounds3, inner: &Bounds3) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

fn mark(reached: &mut [bool], index: usize, what: &str) -> Result<(), String> {
    match reached.get_mut(index) {
        None => Err(format!("{what} {index} does not exist")),
        Some(true) => Err(format!("{what} {index} is reached twice")),
        Some(mark) => {
            *mark = true;
            Ok(())
        }
    }
}

fn all(reached: &[bool], what: &str) -> Result<(), String> {
    match reached.iter().position(|reached| !reached) {
        Some(index) => Err(format!("{what} {index} is not reached")),
        None => Ok(()),
    }
}

fn check_block(bvh: &Bvh, index: usize, bounds: &Bounds3) -> Result<(), String> {
    let block = &bvh.blocks[index];
    for lane in (0..WIDTH).filter(|&lane| block.is_used(lane)) {
        let corners = [0, 1, 2].map(|vertex| block.vertex(vertex, lane));
        // After a spatial split, only a part of the triangle is inside the box.
        if Bounds3::from_points(corners).intersection(*bounds).is_empty() {
            return Err(format!("triangle {lane} of block {index} is outside its box"));
        }
    }
    Ok(())
}
