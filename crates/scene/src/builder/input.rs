//! What a scene is built from, and what the user of the library decides about it.

use crate::cache::AssetCache;
use etendue_bvh::Tier;
use etendue_document::{Document, Resources};
use std::sync::Arc;

/// What a scene is built from.
#[derive(Clone, Copy)]
pub struct SceneInput<'a> {
    /// What the user wrote.
    pub document: &'a Document,
    /// Bytes by name.
    pub resources: &'a dyn Resources,
    /// What the scene's hash is taken over.
    pub identity: Identity,
    /// What earlier scenes were made of. It also keeps what this one is made of.
    pub cache: Option<&'a Arc<AssetCache>>,
}

/// What the hash of a scene is taken over, beside the files that it names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Identity {
    /// The texts of the document, where it is what they say.
    Texts,
    /// The nodes of the document, where it was made or changed in code.
    Nodes,
}

/// What the user of the library decides about a scene, over what its file says.
#[derive(Clone, Debug, Default)]
pub struct BuildOptions {
    /// The film's width and height in pixels.
    pub film_size: Option<[u32; 2]>,
    /// The part of the film that is rendered: x, y, width and height in pixels.
    pub crop: Option<[u32; 4]>,
    /// The film's reconstruction filter, by its XML `type`.
    pub filter: Option<String>,
    /// Whether a missing file is a warning, and the rest of the scene goes on.
    pub skip_missing: bool,
    /// The instructions that rays use; the fastest of this machine if none are named. The hits are
    /// the same.
    pub tier: Option<Tier>,
}
