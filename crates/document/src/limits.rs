//! Limits of a document.

/// Limits of a scene, far above what real scenes need.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentLimits {
    /// The maximum nesting depth of objects, including references.
    pub depth: usize,
    /// The maximum number of objects in the scene.
    pub nodes: usize,
    /// The maximum number of objects that one object expands to if every reference in it is
    /// followed.
    pub expanded_nodes: u64,
}

impl Default for DocumentLimits {
    fn default() -> Self {
        Self { depth: 64, nodes: 4_000_000, expanded_nodes: 1_000_000 }
    }
}
