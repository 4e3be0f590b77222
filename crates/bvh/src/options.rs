//! How a hierarchy is built.

/// Trades the time of the build against the speed of the rays. Start from a preset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildOptions {
    /// In how many slabs per axis a range of primitives is sorted to find its best split
    /// (2 to 16; values outside are brought inside).
    pub bin_count: u32,
    /// So few triangles or fewer are not divided further (1 to 8; values outside are brought
    /// inside). A leaf costs as much to test for one triangle as for eight.
    pub leaf_size: u32,
    /// What visiting a node costs, in units of testing a block of triangles.
    pub node_cost: f32,
    /// How many more references than primitives spatial splits may make, as a part of the number
    /// of primitives; 0 for none, and no more than 8. Large slanted triangles then appear in several leaves, each with
    /// a box around a part. The hierarchy without splits is built too and kept if it is better.
    pub split_budget: f32,
}

impl BuildOptions {
    /// The quickest build: for previews, and scenes that change between frames.
    pub const FAST: Self = Self { bin_count: 8, leaf_size: 8, node_cost: 1.0, split_budget: 0.0 };

    /// A good hierarchy in little time; the default.
    pub const BALANCED: Self =
        Self { bin_count: 16, leaf_size: 8, node_cost: 1.0, split_budget: 0.0 };

    /// Spatial splits where they help (long slanted triangles): the slowest build.
    pub const SPATIAL: Self =
        Self { bin_count: 16, leaf_size: 2, node_cost: 1.0, split_budget: 0.3 };
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self::BALANCED
    }
}
