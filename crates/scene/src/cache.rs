//! What a scene was made of, kept for the scene that an edit makes of it.

mod digest;

pub(crate) use digest::{Digest, NodeDigests};

use etendue_bvh::Bvh;
use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::fmt::{self, Debug};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What is expensive about a scene: geometry, pictures, grids and trees.
///
/// A scene that is built with a cache finds in it what an earlier scene was made of and keeps there
/// what it is made of itself. What is kept is shared with the scene and takes no memory of its own,
/// but for the attributes of meshes.
///
/// Files are taken to be unchanged: whoever knows that one has changed calls [`Self::forget_file`] or
/// starts with an empty cache.
#[derive(Default)]
pub struct AssetCache {
    /// What earlier scenes were made of.
    known: HashMap<Key, Slot>,
    /// What the scene that is being built is made of.
    used: Mutex<HashMap<Key, Slot>>,
}

/// The type of a value, and a digest of all that decides it.
type Key = (TypeId, u128);

#[derive(Clone)]
struct Slot {
    value: Arc<dyn Any + Send + Sync>,
    /// The files it was read from.
    files: Vec<PathBuf>,
}

impl Debug for AssetCache {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("AssetCache")
            .field("known", &self.known.len())
            .field("used", &self.used().len())
            .finish()
    }
}

impl AssetCache {
    /// A cache for the next scene, which knows what this one's scene is made of.
    #[must_use]
    pub fn next(&self) -> Self {
        Self { known: self.used().clone(), used: Mutex::default() }
    }

    /// Forgets what was read from a file, given as [`etendue_document::Document::resolve`] finds it:
    /// the next scene reads it again.
    pub fn forget_file(&self, path: &Path) {
        self.used().retain(|_, slot| !slot.files.iter().any(|file| file == path));
    }

    /// Forgets everything: the next scene reads every file again.
    pub fn forget_all(&self) {
        self.used().clear();
    }

    /// What is known under a digest; from now on it is kept for the next scene, too.
    pub(crate) fn find<T: Any + Send + Sync>(&self, digest: u128) -> Option<Arc<T>> {
        let key = (TypeId::of::<T>(), digest);
        let slot = self.known.get(&key)?;
        let value = Arc::clone(&slot.value).downcast().ok()?;
        self.used().insert(key, slot.clone());
        Some(value)
    }

    /// Keeps a value that was read from `files`.
    pub(crate) fn keep<T: Any + Send + Sync>(
        &self,
        digest: u128,
        value: Arc<T>,
        files: Vec<PathBuf>,
    ) {
        self.used().insert((TypeId::of::<T>(), digest), Slot { value, files });
    }

    /// The tree over shapes and instances, whose geometry `digest` tells.
    pub(crate) fn tree(
        &self,
        digest: u128,
        build: impl FnOnce() -> Result<Bvh, String>,
    ) -> Result<Arc<Bvh>, String> {
        if let Some(tree) = self.find(digest) {
            return Ok(tree);
        }
        let tree = Arc::new(build()?);
        self.keep(digest, Arc::clone(&tree), Vec::new());
        Ok(tree)
    }

    /// A thread that panicked while it held the lock cannot have left an entry half written.
    fn used(&self) -> MutexGuard<'_, HashMap<Key, Slot>> {
        self.used.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
