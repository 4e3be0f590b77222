//! The input of a scene, and the options of the library's user.

use crate::cache::AssetCache;
use etendue_bvh::Tier;
use etendue_document::{Document, Resources};
use std::sync::Arc;

/// The input of a scene.
#[derive(Clone, Copy)]
pub struct SceneInput<'a> {
    /// The scene as the user wrote it.
    pub document: &'a Document,
    /// Bytes by name.
    pub resources: &'a dyn Resources,
    /// The input of the scene's hash.
    pub identity: Identity,
    /// The parts of earlier scenes; also keeps those of this scene.
    pub cache: Option<&'a Arc<AssetCache>>,
}

/// The input of a scene's hash, apart from the files that it names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Identity {
    /// The texts of the document, if they define it.
    Texts,
    /// The nodes of the document, if code made or changed it.
    Nodes,
}

/// Options of the library's user, which override the scene file.
#[derive(Clone, Debug, Default)]
pub struct BuildOptions {
    /// The film's width and height in pixels.
    pub film_size: Option<[u32; 2]>,
    /// The crop of the film: x, y, width and height in pixels.
    pub crop: Option<[u32; 4]>,
    /// The film's reconstruction filter, by its XML `type`.
    pub filter: Option<String>,
    /// Whether a missing file is only a warning, so that the scene is built without it.
    pub skip_missing: bool,
    /// The instruction set for rays; by default the fastest of this machine. Hits do not depend on
    /// it.
    pub tier: Option<Tier>,
    /// The memory in bytes that pictures, meshes and their trees may take together; `None` for any.
    pub memory_limit: Option<u64>,
}
