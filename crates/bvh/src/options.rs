//! Build options.

/// Build options, which trade build time for traversal speed. Start from a preset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildOptions {
    /// The number of bins per axis that a range of primitives is sorted into to find its best split
    /// (clamped to 2 to 16).
    pub bin_count: u32,
    /// Ranges of at most this many triangles are not split further (clamped to 1 to 8). A leaf
    /// costs the same to test for one triangle as for eight.
    pub leaf_size: u32,
    /// The cost of visiting a node, in units of the cost of testing a block of triangles.
    pub node_cost: f32,
    /// The maximum number of references that spatial splits may add, as a fraction of the number of
    /// primitives (0 for none, at most 8). Large slanted triangles then appear in several leaves,
    /// each with a box around a part. The hierarchy without splits is also built, and the better
    /// one is kept.
    pub split_budget: f32,
}

impl BuildOptions {
    /// The fastest build: for previews, and scenes that change between frames.
    pub const FAST: Self = Self { bin_count: 8, leaf_size: 8, node_cost: 1.0, split_budget: 0.0 };

    /// A good hierarchy in a short time; the default.
    pub const BALANCED: Self =
        Self { bin_count: 16, leaf_size: 8, node_cost: 1.0, split_budget: 0.0 };

    /// Spatial splits where they help (long slanted triangles). The slowest build.
    pub const SPATIAL: Self =
        Self { bin_count: 16, leaf_size: 2, node_cost: 1.0, split_budget: 0.3 };
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self::BALANCED
    }
}
