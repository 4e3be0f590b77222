//! Bytes by name: how code without file access gets its files.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Component, Path, PathBuf};

/// Why a resource could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ResourceError {
    /// There is nothing of that name.
    NotFound,
    /// It is larger than the host accepts.
    TooLarge {
        /// The maximum size in bytes.
        limit: u64,
    },
    /// Any other error, in the host's words.
    Other(String),
}

impl fmt::Display for ResourceError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFound => write!(formatter, "no such file"),
            Self::TooLarge { limit } => write!(formatter, "larger than {limit} bytes"),
            Self::Other(message) => write!(formatter, "{message}"),
        }
    }
}

impl std::error::Error for ResourceError {}

/// The files that a host provides.
pub trait Resources: Send + Sync {
    /// The whole content of a file.
    ///
    /// # Errors
    ///
    /// If there is no such file or it cannot be read.
    fn read(&self, path: &Path) -> Result<Vec<u8>, ResourceError>;

    /// Whether there is a file (not a folder) of that name.
    fn exists(&self, path: &Path) -> bool;

    /// The names of a folder's entries, to suggest similar ones if a file is missing. Empty if the
    /// host cannot list them.
    fn list(&self, _folder: &Path) -> Vec<String> {
        Vec::new()
    }
}

/// Resources held in memory, for tests and embedded scenes. Paths are normalised for comparison.
#[derive(Clone, Debug, Default)]
pub struct MemoryResources {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl MemoryResources {
    /// Adds or replaces a file.
    pub fn insert(&mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) {
        self.files.insert(normalise(&path.into()), bytes.into());
    }

    /// Like [`Self::insert`], for building a collection in one expression.
    #[must_use]
    pub fn with(mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) -> Self {
        self.insert(path, bytes);
        self
    }
}

impl Resources for MemoryResources {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ResourceError> {
        self.files.get(&normalise(path)).cloned().ok_or(ResourceError::NotFound)
    }

    fn exists(&self, path: &Path) -> bool {
        self.files.contains_key(&normalise(path))
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        let folder = normalise(folder);
        let inside = self.files.keys().filter(|path| path.parent() == Some(&folder));
        inside.filter_map(|path| Some(path.file_name()?.to_str()?.to_owned())).collect()
    }
}

/// Normalises a path lexically: removes `.` and resolves `..`, as
/// [`Resolver::resolve`](crate::Resolver::resolve) does.
pub fn normalise(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => match normal.components().next_back() {
                Some(Component::Normal(_)) => {
                    normal.pop();
                }
                Some(Component::RootDir | Component::Prefix(_)) => {}
                _ => normal.push(".."),
            },
            other => normal.push(other),
        }
    }
    normal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parent_folders_are_resolved_by_name() {
        assert_eq!(normalise(Path::new("/a/./b/../../../c")), PathBuf::from("/c"));
        assert_eq!(normalise(Path::new("../a/..")), PathBuf::from(".."));
    }
}
