//! The memory layout of nodes and leaves.

use etendue_math::Bounds3;
use glam::Vec3;

/// The maximum number of children of a node, and of triangles in a block.
pub(crate) const WIDTH: usize = 8;

/// One value per child of a node, or per triangle of a block.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct F32x8(pub(crate) [f32; WIDTH]);

/// A wide node: the boxes of up to eight children in structure-of-arrays layout, and the children.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// The planes min x, max x, min y, max y, min z, max z; an empty slot has min = ∞, max = -∞.
    pub(crate) planes: [F32x8; 6],
    /// The contents of the slots.
    pub(crate) children: [Child; WIDTH],
}

const _: () = assert!(size_of::<Node>() == 256);

/// The content of a slot, packed into one word: another node, a block of triangles, or up to
/// [`Child::MAX_CUSTOM`] user primitives and instances.
///
/// Nodes and blocks are addressed by their offsets from the first, in units of 8 and 32 bytes: the
/// multiplication of an index would lengthen the critical path of the traversal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Child(pub(crate) u32);

/// The lengths of all arrays that a [`Child`] may refer to.
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

/// [`Child`], unpacked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChildKind {
    /// The node with this index.
    Node(usize),
    /// The block with this index.
    Block(usize),
    /// These entries of the list of custom primitives.
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

    /// The maximum number of nodes.
    pub(crate) const MAX_NODES: usize = (1 << 31) / Self::NODE_UNITS;
    /// The maximum number of blocks.
    pub(crate) const MAX_BLOCKS: usize = (1 << 30) / Self::BLOCK_UNITS;
    /// The maximum number of custom entries.
    pub(crate) const MAX_CUSTOM_ENTRIES: usize = 1 << Self::COUNT_SHIFT;
    /// The maximum number of custom entries in one leaf.
    pub(crate) const MAX_CUSTOM: usize = 4;

    /// An empty slot: a custom leaf without entries, which is harmless to visit.
    pub(crate) const EMPTY: Self = Self(Self::LEAF | Self::CUSTOM);

    /// A sentinel at the bottom of the traversal stack that ends the traversal.
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

    /// The same child after the arrays that it refers to have moved back by `by`.
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

    /// The offset of a node from the first, in bytes.
    #[inline(always)]
    pub(crate) fn node_offset(self) -> usize {
        self.0 as usize * Self::NODE_UNIT
    }

    /// The block that this child refers to.
    ///
    /// # Safety
    ///
    /// `self` must refer to one of `blocks`.
    #[inline(always)]
    pub(crate) unsafe fn block_of(self, blocks: &[TriangleBlock]) -> &TriangleBlock {
        let offset = (self.0 & !Self::LEAF) as usize * Self::BLOCK_UNIT;
        // SAFETY: the caller guarantees that this is the offset of a block of the slice.
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
    /// The children as raw words.
    #[inline(always)]
    pub(crate) fn words(&self) -> &[u32; WIDTH] {
        // SAFETY: `Child` is a transparent wrapper of `u32`.
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

    /// The same node after the arrays that its children refer to have moved back by `by`.
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

/// A leaf of one to eight triangles.
///
/// Unused lanes repeat the id of the first triangle, and its first edge as a degenerate triangle:
/// one of its edge functions is zero, and the other two are exact negatives of each other, so no
/// ray passes inside. If they repeated the whole triangle, rays that hit it would have to choose
/// between equal hits.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    /// The coordinates, indexed by vertex, axis and lane.
    pub(crate) vertices: [[F32x8; 3]; 3],
    /// The id of the triangle in each lane; see
    /// [`TriangleIds`](crate::triangle_ids::TriangleIds).
    pub(crate) ids: [u32; WIDTH],
}

const _: () = assert!(size_of::<TriangleBlock>() == 320);
const _: () = assert!(size_of::<TriangleBlock>().is_multiple_of(Child::BLOCK_UNIT));

impl TriangleBlock {
    /// A block with all coordinates zero.
    pub(crate) const EMPTY: Self =
        Self { vertices: [[F32x8([0.0; WIDTH]); 3]; 3], ids: [u32::MAX; WIDTH] };

    pub(crate) fn set(&mut self, lane: usize, id: u32, corners: [Vec3; 3]) {
        for (vertex, corner) in self.vertices.iter_mut().zip(corners) {
            for axis in 0..3 {
                vertex[axis].0[lane] = corner[axis];
            }
        }
        self.ids[lane] = id;
    }

    /// Whether a triangle is in the lane.
    pub(crate) fn is_used(&self, lane: usize) -> bool {
        lane == 0 || self.ids[lane] != self.ids[0]
    }

    pub(crate) fn vertex(&self, vertex: usize, lane: usize) -> Vec3 {
        let [x, y, z] = &self.vertices[vertex];
        Vec3::new(x.0[lane], y.0[lane], z.0[lane])
    }
}

/// An entry of a custom leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Custom {
    /// A primitive that the caller intersects.
    User { geometry: u32, primitive: u32 },
    /// An index into the list of instances.
    Instance { index: u32 },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_child_unpacks_to_what_it_was_packed_from() {
        assert_eq!(Child::node(77).kind(), ChildKind::Node(77));
        assert_eq!(Child::block(77).kind(), ChildKind::Block(77));
        assert_eq!(Child::custom(77, 4).kind(), ChildKind::Custom { first: 77, count: 4 });
        assert_eq!(Child::EMPTY.kind(), ChildKind::Custom { first: 0, count: 0 });
    }
}
