//! How much a document may hold.

/// Bounds on what a scene may ask for, far above what real scenes need.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentLimits {
    /// How deep objects may nest, references counted in.
    pub depth: usize,
    /// Objects of the whole scene.
    pub nodes: usize,
    /// How many objects one object may come to when every reference in it is followed.
    pub expanded_nodes: u64,
}

impl Default for DocumentLimits {
    fn default() -> Self {
        Self { depth: 64, nodes: 4_000_000, expanded_nodes: 1_000_000 }
    }
}
