//! Optimises a binary tree by reinsertion: subtrees are moved to where they enlarge boxes less.
//!
//! Bittner, Hapala and Havran, *Fast Insertion-Based Optimization of Bounding Volume Hierarchies*
//! (Computer Graphics Forum 2013), with the search of Meister and Bittner, *Parallel Reinsertion for
//! Bounding Volume Hierarchy Optimization* (Computer Graphics Forum 2018), which starts at the old
//! position and walks up. Sequential, largest subtrees first: the tree is small.

use super::extent::Box4;
use super::top_node::{Below, TopNode};

/// The number of passes over all nodes. A fourth finds hardly any improvement.
const PASSES: usize = 3;

/// Moves subtrees until the search has visited `visits` nodes. The root stays first, and nodes keep
/// their indices.
pub(super) fn improve(nodes: &mut [TopNode], visits: usize) {
    let mut search = Search { stack: Vec::new(), visits };
    for _ in 0..PASSES {
        let mut order: Vec<u32> = (1..nodes.len() as u32).collect();
        // Areas are not negative, so their bits sort like the floats.
        order.sort_unstable_by_key(|&index| (!nodes[index as usize].area().to_bits(), index));
        for index in order {
            if let Some(place) = search.best_place(nodes, index) {
                relocate(nodes, index, place);
            }
        }
    }
}

/// The search for better positions.
struct Search {
    /// Nodes yet to be visited, each with the area saved above it.
    stack: Vec<(f32, u32)>,
    /// The remaining number of visits.
    visits: usize,
}

impl Search {
    /// The best new sibling of a node, if that saves area.
    ///
    /// Removing a node also removes its parent, and shrinks its ancestors up to the node where the
    /// path to the new position branches off. Inserting it adds a new parent there, and enlarges
    /// the nodes on the path.
    fn best_place(&mut self, nodes: &[TopNode], index: u32) -> Option<u32> {
        let moved = &nodes[index as usize];
        let area = moved.area();
        let parent = moved.parent;
        if parent == TopNode::NONE || nodes[parent as usize].parent == TopNode::NONE {
            return None;
        }
        let old_sibling = sibling(nodes, index);
        let mut best = (0.0, None);
        let mut saved = nodes[parent as usize].area();
        let (mut pivot, mut branch) = (parent, old_sibling);
        let mut shrunken = nodes[old_sibling as usize].bounds;
        loop {
            self.stack.push((saved, branch));
            while let Some((saved, place)) = self.stack.pop() {
                if saved - area <= best.0 {
                    continue;
                }
                if self.visits == 0 {
                    self.stack.clear();
                    return None;
                }
                self.visits -= 1;
                let node = &nodes[place as usize];
                let saved = saved - union(&node.bounds, &moved.bounds).half_area();
                if saved > best.0 && place != old_sibling {
                    best = (saved, Some(place));
                }
                if let Below::Nodes(children) = node.below {
                    let saved = saved + node.area();
                    self.stack.extend(children.map(|child| (saved, child)));
                }
            }
            if pivot != parent {
                shrunken.grow(&nodes[branch as usize].bounds);
                saved += nodes[pivot as usize].area() - shrunken.half_area();
            }
            let above = nodes[pivot as usize].parent;
            if above == TopNode::NONE {
                return best.1;
            }
            branch = sibling(nodes, pivot);
            pivot = above;
        }
    }
}

fn union(a: &Box4, b: &Box4) -> Box4 {
    let mut both = *a;
    both.grow(b);
    both
}

/// The other child of the parent.
fn sibling(nodes: &[TopNode], index: u32) -> u32 {
    match nodes[nodes[index as usize].parent as usize].below {
        Below::Nodes([left, right]) if left == index => right,
        Below::Nodes([left, _]) => left,
        // Unreachable: parents have children.
        Below::Part(_) => index,
    }
}

/// Makes a node the sibling of another. Its old parent, which is not the root, becomes their parent.
fn relocate(nodes: &mut [TopNode], index: u32, place: u32) {
    let parent = nodes[index as usize].parent;
    let above = nodes[parent as usize].parent;
    replace_child(nodes, above, [parent, sibling(nodes, index)]);
    refit(nodes, above);
    let above = nodes[place as usize].parent;
    replace_child(nodes, above, [place, parent]);
    nodes[parent as usize].below = Below::Nodes([place, index]);
    nodes[place as usize].parent = parent;
    refit(nodes, parent);
}

fn replace_child(nodes: &mut [TopNode], parent: u32, [old, new]: [u32; 2]) {
    if let Below::Nodes(children) = &mut nodes[parent as usize].below {
        children.iter_mut().filter(|child| **child == old).for_each(|child| *child = new);
    }
    nodes[new as usize].parent = parent;
}

/// Recomputes the boxes of a node and its ancestors.
fn refit(nodes: &mut [TopNode], from: u32) {
    let mut index = from;
    while index != TopNode::NONE {
        let Below::Nodes([left, right]) = nodes[index as usize].below else { return };
        let bounds = union(&nodes[left as usize].bounds, &nodes[right as usize].bounds);
        nodes[index as usize].bounds = bounds;
        index = nodes[index as usize].parent;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    /// A degenerate tree: every node has one part and the rest of the chain.
    fn chain(parts: &[Box4]) -> Vec<TopNode> {
        let last = parts.len() as u32 - 1;
        let mut nodes = Vec::new();
        for (part, bounds) in (0_u32..).zip(parts) {
            let mut whole = *bounds;
            parts[part as usize..].iter().for_each(|other| whole.grow(other));
            let above = (2 * part).checked_sub(2).unwrap_or(TopNode::NONE);
            if part < last {
                let children = [2 * part + 1, 2 * part + 2];
                nodes.push(TopNode { bounds: whole, parent: above, below: Below::Nodes(children) });
            }
            let parent = if part < last { 2 * part } else { above };
            nodes.push(TopNode { bounds: *bounds, parent, below: Below::Part(part) });
        }
        nodes
    }

    /// Unit boxes along an axis, in an order scrambled by a stride.
    fn scattered(count: usize, stride: usize) -> Vec<Box4> {
        let corner = |number: usize| Vec4::new((number * stride % count) as f32, 0.0, 0.0, 0.0);
        (0..count)
            .map(|number| Box4 { min: corner(number), negated_max: -corner(number) - Vec4::ONE })
            .collect()
    }

    fn total_area(nodes: &[TopNode]) -> f32 {
        nodes.iter().map(TopNode::area).sum()
    }

    /// The parts below a node in ascending order, after checking links and boxes.
    fn parts_below(nodes: &[TopNode], index: u32) -> Vec<u32> {
        let node = &nodes[index as usize];
        let children = match node.below {
            Below::Part(part) => return vec![part],
            Below::Nodes(children) => children,
        };
        let [left, right] = children.map(|child| &nodes[child as usize]);
        assert_eq!([left.parent, right.parent], [index; 2]);
        let both = union(&left.bounds, &right.bounds);
        assert_eq!((both.min, both.negated_max), (node.bounds.min, node.bounds.negated_max));
        let mut parts: Vec<u32> =
            children.iter().flat_map(|&child| parts_below(nodes, child)).collect();
        parts.sort_unstable();
        parts
    }

    #[test]
    fn scattered_parts_find_their_neighbours() {
        let mut nodes = chain(&scattered(64, 37));
        let before = total_area(&nodes);
        improve(&mut nodes, usize::MAX);
        assert_eq!(parts_below(&nodes, 0), (0..64).collect::<Vec<u32>>());
        // The best tree halves the row on each of six levels: 2ᵏ nodes of half area 2 · 64/2ᵏ + 1.
        let best: f32 = (0..=6).map(|level| 128.0 + f32::from(1_u8 << level)).sum();
        let after = total_area(&nodes);
        let (saved, possible) = (before - after, before - best);
        assert!(saved > 0.95 * possible, "{before} became {after}; the optimum is {best}");
    }

    #[test]
    fn without_visits_nothing_moves() {
        let mut nodes = chain(&scattered(16, 5));
        let before = nodes.clone();
        improve(&mut nodes, 0);
        for (old, new) in before.iter().zip(&nodes) {
            assert_eq!((old.parent, old.below), (new.parent, new.below));
        }
    }
}
