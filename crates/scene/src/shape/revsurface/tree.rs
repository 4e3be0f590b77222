//! A tree over the pieces of a profile.
//!
//! Boxes in space around rings are mostly empty. Here, boxes are intervals of height and of
//! distance from the axis, which a ray is tested against exactly: it is in the slab between two
//! heights for an interval of t, and its squared distance from the axis is a parabola over that
//! interval.

use super::line::Line;
use glam::Vec4;
use std::ops::ControlFlow;

/// A bound on single-precision rounding, where lengths are at most about one.
const PADDING: f32 = 2e-6;
/// Three waiting children per level, and some to spare: 4¹⁶ pieces.
const STACK_SIZE: usize = 52;

/// A box in the half plane: heights, and squared distances from the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) heights: [f64; 2],
    pub(super) squares: [f64; 2],
}

impl Extent {
    fn union(self, other: Self) -> Self {
        let unite = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self {
            heights: unite(self.heights, other.heights),
            squares: unite(self.squares, other.squares),
        }
    }
}

/// Four children, one per lane.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: Vec4,
    high: Vec4,
    least_square: Vec4,
    greatest_square: Vec4,
    /// The first of the four: a piece or a node.
    first_child: u32,
    is_leaf: bool,
}

impl Node {
    fn new(first_child: usize, is_leaf: bool, children: &[Extent]) -> Self {
        // Lanes without a child have an empty distance interval.
        let lane = |value: fn(&Extent) -> f32, empty: f32| {
            Vec4::from_array(std::array::from_fn(|i| children.get(i).map_or(empty, value)))
        };
        Self {
            low: lane(|e| e.heights[0] as f32 - PADDING, 0.0),
            high: lane(|e| e.heights[1] as f32 + PADDING, 0.0),
            least_square: lane(|e| e.squares[0] as f32 - PADDING, f32::INFINITY),
            greatest_square: lane(|e| e.squares[1] as f32 + PADDING, f32::NEG_INFINITY),
            first_child: first_child as u32,
            is_leaf,
        }
    }
}

/// The tree. Neighbours along the profile are neighbours in the tree.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
}

/// A line in the form that box tests need.
struct Probe {
    height: Vec4,
    inverse_rise: Vec4,
    /// The squared distance from the axis is (`square`·t + `linear`)·t + `constant`.
    square: Vec4,
    linear: Vec4,
    constant: Vec4,
    nearest: Vec4,
}

impl Probe {
    fn new(line: &Line) -> Self {
        let (p, v) = (line.origin, line.direction);
        let inverse = if line.rise == 0.0 { 1e30 } else { (1.0 / line.rise) as f32 };
        Self {
            height: Vec4::splat(p.y as f32),
            inverse_rise: Vec4::splat(inverse),
            square: Vec4::splat(line.across as f32),
            linear: Vec4::splat((2.0 * (p.x * v.x + p.z * v.z)) as f32),
            constant: Vec4::splat((p.x * p.x + p.z * p.z) as f32),
            nearest: Vec4::splat(line.nearest as f32),
        }
    }

    /// Which children the line meets between `near` and `far`, and where it enters them.
    #[inline(always)]
    fn meet(&self, node: &Node, near: f32, far: f32) -> (u32, [f32; 4]) {
        let first = (node.low - self.height) * self.inverse_rise;
        let second = (node.high - self.height) * self.inverse_rise;
        let enter = first.min(second).max(Vec4::splat(near));
        let leave = first.max(second).min(Vec4::splat(far));
        let square = |t: Vec4| (self.square * t + self.linear) * t + self.constant;
        let greatest = square(enter).max(square(leave));
        let least = square(self.nearest.max(enter).min(leave));
        let met = enter.cmple(leave)
            & least.cmple(node.greatest_square)
            & greatest.cmpge(node.least_square);
        (met.bitmask(), enter.to_array())
    }
}

impl Tree {
    /// Builds the tree over pieces with these boxes. At least one is required.
    pub(super) fn new(pieces: &[Extent]) -> Self {
        let mut nodes: Vec<Node> = Vec::new();
        let mut level = pieces.to_vec();
        let mut first = 0;
        let mut is_leaf = true;
        loop {
            let next_first = nodes.len();
            for (index, children) in level.chunks(4).enumerate() {
                nodes.push(Node::new(first + 4 * index, is_leaf, children));
            }
            level = level
                .chunks(4)
                .map(|children| {
                    children.iter().copied().reduce(Extent::union).unwrap_or(children[0])
                })
                .collect();
            if level.len() <= 1 {
                return Self { nodes };
            }
            (first, is_leaf) = (next_first, false);
        }
    }

    /// Calls `visit` with the pieces that `line` may hit between `near` and `far`, roughly from
    /// near to far, until it breaks. `visit` may reduce `far`.
    #[inline]
    pub(super) fn each_piece<B>(
        &self,
        line: &Line,
        [near, mut far]: [f64; 2],
        mut visit: impl FnMut(usize, &mut f64) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let probe = Probe::new(line);
        let near = near as f32 - PADDING;
        let mut stack = [(0.0_f32, 0_u32); STACK_SIZE];
        stack[0] = (near, self.nodes.len() as u32 - 1);
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (enter, index) = stack[waiting];
            let padded = far as f32 + PADDING;
            if enter > padded {
                continue;
            }
            let node = &self.nodes[index as usize];
            let (mut met, enters) = probe.meet(node, near, padded);
            // The nearest child goes on top of the stack.
            let bottom = waiting;
            while met != 0 {
                let lane = met.trailing_zeros() as usize & 3;
                met &= met - 1;
                let entry = (enters[lane], node.first_child + lane as u32);
                let mut place = waiting;
                while place > bottom && stack[place - 1].0 < entry.0 {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = entry;
                waiting += 1;
            }
            if node.is_leaf {
                for place in (bottom..waiting).rev() {
                    let (enter, piece) = stack[place];
                    if enter <= far as f32 + PADDING {
                        visit(piece as usize, &mut far)?;
                    }
                }
                waiting = bottom;
            }
        }
        ControlFlow::Continue(())
    }

    /// Memory use in bytes.
    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }
}
