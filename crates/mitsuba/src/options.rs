//! Options and limits of a load.

use std::path::PathBuf;

use etendue_document::DocumentLimits;

/// How a scene is loaded.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Values for `$name`, which override the scene's defaults.
    pub defines: Vec<(String, String)>,
    /// Additional folders in which files are looked up.
    pub search_paths: Vec<PathBuf>,
    /// The base of relative paths.
    pub working_directory: PathBuf,
    /// Limits on the scene.
    pub limits: Limits,
}

/// Limits of a scene, far above what real scenes need.
#[derive(Clone, Debug)]
pub struct Limits {
    /// The total size of all files in bytes, each counted as often as it is included.
    pub total_bytes: usize,
    /// Limits of the document. Its depth also bounds the nesting of elements, including includes.
    pub document: DocumentLimits,
    /// The number of attributes of one element.
    pub attributes: usize,
    /// The size in bytes of a top-level object, which is parsed at once.
    pub object_bytes: usize,
    /// The number of elements of one file.
    pub elements: usize,
    /// The number of XML nodes (elements, texts, comments) that are parsed at once.
    pub xml_nodes: u32,
    /// The nesting depth of includes.
    pub include_depth: usize,
    /// The total number of includes.
    pub includes: usize,
    /// The number of `<path>` entries; every file is looked up in all of them.
    pub paths: usize,
    /// The number of bytes that all `$name` expansions together may produce.
    pub expansion_bytes: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            // Room for a million instances, each with a matrix in full precision.
            total_bytes: 512 << 20,
            document: DocumentLimits::default(),
            attributes: 64,
            // The parser needs a dozen bytes for each of these.
            object_bytes: 128 << 20,
            elements: 12_000_000,
            xml_nodes: 4_000_000,
            include_depth: 16,
            includes: 10_000,
            paths: 100,
            expansion_bytes: 16 << 20,
        }
    }
}
