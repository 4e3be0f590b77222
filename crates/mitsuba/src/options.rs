//! Options and limits of a load.

use std::path::PathBuf;

use etendue_document::DocumentLimits;

/// How a scene is loaded.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Values for `$name`, which replace the scene's own defaults.
    pub defines: Vec<(String, String)>,
    /// Folders in which files are looked for, beside the scene's own.
    pub search_paths: Vec<PathBuf>,
    /// Where relative paths start.
    pub working_directory: PathBuf,
    /// How much a scene may ask for.
    pub limits: Limits,
}

/// Bounds on what a scene may ask for, far above what real scenes need.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Bytes of all files together, each counted as often as it is included.
    pub total_bytes: usize,
    /// Limits of the document. Its depth bounds the nesting of elements too, includes counted in.
    pub document: DocumentLimits,
    /// Attributes of one element.
    pub attributes: usize,
    /// Bytes of an object right inside the scene, which is parsed at once.
    pub object_bytes: usize,
    /// Elements of one file.
    pub elements: usize,
    /// XML nodes (elements, texts, comments) that are parsed at once.
    pub xml_nodes: u32,
    /// How deep files may include each other.
    pub include_depth: usize,
    /// Includes in total.
    pub includes: usize,
    /// `<path>` entries; every file is sought in all of them.
    pub paths: usize,
    /// Bytes that all `$name` expansions together may produce.
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
