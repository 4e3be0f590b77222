//! The nodes and leaves as they lie in memory.

use etendue_math::Bounds3;
use glam::Vec3;

/// How many children a node has at most, and how many triangles a block.
pub(crate) const WIDTH: usize = 8;

/// One number for each child of a node or each triangle of a block.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct F32x8(pub(crate) [f32; WIDTH]);

/// Up to eight children: their boxes as a structure of arrays, and what they are.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// The planes min x, max x, min y, max y, min z, max z; an empty slot has min = ∞, max = -∞.
    pub(crate) planes: [F32x8; 6],
    /// What the slots hold.
    pub(crate) children: [Child; WIDTH],
}

const _: () = assert!(size_of::<Node>() == 256);

/// What a slot of a node holds, in one word: another node, a block of triangles, or up to
/// [`Child::MAX_CUSTOM`] user primitives and instances.
///
/// Nodes and blocks are named by their distance from the first, in units of 8 and 32 bytes, because
/// the multiplication of an index would be on the longest chain of a traversal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Child(pub(crate) u32);

/// How many there are of everything that a [`Child`] may name.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Lengths {
    pub(crate) nodes: usize,
    pub(crate) blocks: usize,
    pub(crate) custom: usize,
}

impl Lengths {
    pub(crate) fn plus(self, others: Self) -> Self {
        Self {
            nodes: self.nodes + others.nodes,
            blocks: self.blocks + others.blocks,
            custom: self.custom + others.custom,
        }
    }
}

/// [`Child`], spelled out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChildKind {
    /// The node with this number.
    Node(usize),
    /// The block with this number.
    Block(usize),
    /// These entries of the custom list.
    Custom { first: usize, count: usize },
}

impl Child {
    const LEAF: u32 = 1 << 31;
    const CUSTOM: u32 = 1 << 30;
    const COUNT_SHIFT: u32 = 27;
    const NODE_UNIT: usize = 8;
    const BLOCK_UNIT: usize = 32;
    const NODE_UNITS: usize = size_of::<Node>() / Self::NODE_UNIT;
    const BLOCK_UNITS: usize = size_of::<TriangleBlock>() / Self::BLOCK_UNIT;

    /// No more nodes than this.
    pub(crate) const MAX_NODES: usize = (1 << 31) / Self::NODE_UNITS;
    /// No more blocks than this.
    pub(crate) const MAX_BLOCKS: usize = (1 << 30) / Self::BLOCK_UNITS;
    /// No more custom entries than this.
    pub(crate) const MAX_CUSTOM_ENTRIES: usize = 1 << Self::COUNT_SHIFT;
    /// No more custom entries in one leaf than this.
    pub(crate) const MAX_CUSTOM: usize = 4;

    /// An empty slot: a custom leaf without entries, harmless if visited.
    pub(crate) const EMPTY: Self = Self(Self::LEAF | Self::CUSTOM);

    /// No child: what lies below all that wait, and ends a traversal.
    pub(crate) const END: Self = Self(Self::LEAF | Self::CUSTOM | 7 << Self::COUNT_SHIFT);

    pub(crate) fn node(index: usize) -> Self {
        debug_assert!(index < Self::MAX_NODES);
        Self((index * Self::NODE_UNITS) as u32)
    }

    pub(crate) fn block(index: usize) -> Self {
        debug_assert!(index < Self::MAX_BLOCKS);
        Self(Self::LEAF | (index * Self::BLOCK_UNITS) as u32)
    }

    pub(crate) fn custom(first: usize, count: usize) -> Self {
        debug_assert!(first < Self::MAX_CUSTOM_ENTRIES && count <= Self::MAX_CUSTOM);
        Self(Self::LEAF | Self::CUSTOM | (count as u32) << Self::COUNT_SHIFT | first as u32)
    }

    /// The same child where all that it may name lies further behind.
    pub(crate) fn moved(self, by: &Lengths) -> Self {
        let units = match self.kind() {
            ChildKind::Node(_) => by.nodes * Self::NODE_UNITS,
            ChildKind::Block(_) => by.blocks * Self::BLOCK_UNITS,
            ChildKind::Custom { count: 0, .. } => 0,
            ChildKind::Custom { .. } => by.custom,
        };
        Self(self.0 + units as u32)
    }

    #[inline(always)]
    pub(crate) fn is_node(self) -> bool {
        (self.0 as i32) >= 0
    }

    #[inline(always)]
    pub(crate) fn is_block(self) -> bool {
        self.0 & (Self::LEAF | Self::CUSTOM) == Self::LEAF
    }

    /// The distance of a node from the first in bytes.
    #[inline(always)]
    pub(crate) fn node_offset(self) -> usize {
        self.0 as usize * Self::NODE_UNIT
    }

    /// The block.
    ///
    /// # Safety
    ///
    /// `self` must have been made for one of `blocks`.
    #[inline(always)]
    pub(crate) unsafe fn block_of(self, blocks: &[TriangleBlock]) -> &TriangleBlock {
        let offset = (self.0 & !Self::LEAF) as usize * Self::BLOCK_UNIT;
        // SAFETY: `Child::block` has made the distance of a block of the slice, says the caller.
        unsafe { &*blocks.as_ptr().cast::<u8>().add(offset).cast::<TriangleBlock>() }
    }

    pub(crate) fn kind(self) -> ChildKind {
        if self.is_node() {
            ChildKind::Node(self.0 as usize / Self::NODE_UNITS)
        } else if self.0 & Self::CUSTOM == 0 {
            ChildKind::Block((self.0 & !Self::LEAF) as usize / Self::BLOCK_UNITS)
        } else {
            ChildKind::Custom {
                first: (self.0 & ((1 << Self::COUNT_SHIFT) - 1)) as usize,
                count: (self.0 >> Self::COUNT_SHIFT & 7) as usize,
            }
        }
    }
}

impl Node {
    /// The children as plain words.
    #[inline(always)]
    pub(crate) fn words(&self) -> &[u32; WIDTH] {
        // SAFETY: `Child` is a `u32` by its representation.
        unsafe { &*(&raw const self.children).cast() }
    }

    /// A node without children.
    pub(crate) const EMPTY: Self = {
        let (least, greatest) = (F32x8([f32::INFINITY; WIDTH]), F32x8([f32::NEG_INFINITY; WIDTH]));
        Self {
            planes: [least, greatest, least, greatest, least, greatest],
            children: [Child::EMPTY; WIDTH],
        }
    };

    pub(crate) fn set(&mut self, slot: usize, bounds: Bounds3, child: Child) {
        for axis in 0..3 {
            self.planes[2 * axis].0[slot] = bounds.min[axis];
            self.planes[2 * axis + 1].0[slot] = bounds.max[axis];
        }
        self.children[slot] = child;
    }

    /// The same node where all that its children may name lies further behind.
    pub(crate) fn moved(&self, by: &Lengths) -> Self {
        Self { planes: self.planes, children: self.children.map(|child| child.moved(by)) }
    }

    pub(crate) fn bounds(&self, slot: usize) -> Bounds3 {
        let plane = |which: usize| {
            Vec3::new(
                self.planes[which].0[slot],
                self.planes[2 + which].0[slot],
                self.planes[4 + which].0[slot],
            )
        };
        Bounds3::new(plane(0), plane(1))
    }
}

/// A leaf of one to eight triangles, each with a name of its own.
///
/// Unused lanes have the name of the first, and its first edge as a triangle without area: of the
/// edge functions one is zero then, and the others are each other's negative to the last bit, so
/// that no ray passes inside. Where they repeated the whole triangle, rays that hit it had to choose
/// between equal hits.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    /// The coordinates: vertex, axis, lane.
    pub(crate) vertices: [[F32x8; 3]; 3],
    /// What each lane is, in [`TriangleNumbers`](crate::triangle_numbers::TriangleNumbers).
    pub(crate) names: [u32; WIDTH],
}

const _: () = assert!(size_of::<TriangleBlock>() == 320);
const _: () = assert!(size_of::<TriangleBlock>().is_multiple_of(Child::BLOCK_UNIT));

impl TriangleBlock {
    /// A block of zeros.
    pub(crate) const EMPTY: Self =
        Self { vertices: [[F32x8([0.0; WIDTH]); 3]; 3], names: [u32::MAX; WIDTH] };

    pub(crate) fn set(&mut self, lane: usize, name: u32, corners: [Vec3; 3]) {
        for (vertex, corner) in self.vertices.iter_mut().zip(corners) {
            for axis in 0..3 {
                vertex[axis].0[lane] = corner[axis];
            }
        }
        self.names[lane] = name;
    }

    /// Whether a triangle is in the lane.
    pub(crate) fn is_used(&self, lane: usize) -> bool {
        lane == 0 || self.names[lane] != self.names[0]
    }

    pub(crate) fn vertex(&self, vertex: usize, lane: usize) -> Vec3 {
        let [x, y, z] = &self.vertices[vertex];
        Vec3::new(x.0[lane], y.0[lane], z.0[lane])
    }
}

/// A user primitive or, with `primitive` = `u32::MAX` and `instance` in its place, an instance.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Custom {
    /// A primitive that the caller intersects.
    User { geometry: u32, primitive: u32 },
    /// The entry of the list of instances.
    Instance { index: u32 },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_child_says_what_it_was_made_of() {
        assert_eq!(Child::node(77).kind(), ChildKind::Node(77));
        assert_eq!(Child::block(77).kind(), ChildKind::Block(77));
        assert_eq!(Child::custom(77, 4).kind(), ChildKind::Custom { first: 77, count: 4 });
        assert_eq!(Child::EMPTY.kind(), ChildKind::Custom { first: 0, count: 0 });
    }
}
