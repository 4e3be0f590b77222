//! Files on disk as [`Resources`]. This is the only place in the library that opens files for
//! hosts.
#![allow(
    clippy::disallowed_methods,
    reason = "hosts choose this module when they want files to be read; nothing else here calls it"
)]

use std::fs;
use std::io::{ErrorKind, Read};
use std::path::Path;

use etendue_document::{ResourceError, Resources};

/// The files of this machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Files {
    /// The maximum size of a file in bytes.
    pub size_limit: u64,
}

impl Default for Files {
    /// Files up to 16 GiB.
    fn default() -> Self {
        Self { size_limit: 16 << 30 }
    }
}

impl Resources for Files {
    /// Reads a regular file. Pipes and devices are refused because they may never end.
    fn read(&self, path: &Path) -> Result<Vec<u8>, ResourceError> {
        // Opening a pipe would block, so check the file type first.
        let metadata = fs::metadata(path).map_err(|error| resource_error(&error))?;
        if !metadata.is_file() {
            return Err(ResourceError::Other("not a file".to_owned()));
        }
        if metadata.len() > self.size_limit {
            return Err(ResourceError::TooLarge { limit: self.size_limit });
        }
        let mut bytes = Vec::new();
        let wanted = usize::try_from(metadata.len()).unwrap_or(usize::MAX);
        bytes
            .try_reserve_exact(wanted)
            .map_err(|_| ResourceError::Other(format!("no memory for {wanted} bytes")))?;
        // A file may grow while it is read, and some report no size at all.
        let file = fs::File::open(path).map_err(|error| resource_error(&error))?;
        let read = file.take(self.size_limit + 1).read_to_end(&mut bytes);
        read.map_err(|error| resource_error(&error))?;
        if bytes.len() as u64 > self.size_limit {
            return Err(ResourceError::TooLarge { limit: self.size_limit });
        }
        Ok(bytes)
    }

    fn exists(&self, path: &Path) -> bool {
        path.is_file()
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        /// Enough to suggest a name; a folder may hold millions.
        const LISTED: usize = 10_000;
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.take(LISTED).filter_map(|entry| entry.file_name().into_string().ok()).collect()
    }
}

fn resource_error(error: &std::io::Error) -> ResourceError {
    match error.kind() {
        ErrorKind::NotFound => ResourceError::NotFound,
        _ => ResourceError::Other(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_whole_and_folders_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "hello").unwrap();
        let files = Files::default();
        assert_eq!(files.read(&path), Ok(b"hello".to_vec()));
        assert!(files.exists(&path));
        assert_eq!(files.list(folder.path()), ["a.txt"]);
        assert!(!files.exists(folder.path()));
        assert!(matches!(files.read(folder.path()), Err(ResourceError::Other(_))));
        assert_eq!(files.read(&folder.path().join("b")), Err(ResourceError::NotFound));
    }

    #[test]
    fn large_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "hello").unwrap();
        let limited = Files { size_limit: 4 };
        assert_eq!(limited.read(&path), Err(ResourceError::TooLarge { limit: 4 }));
        assert!(Files { size_limit: 5 }.read(&path).is_ok());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_without_an_end_are_refused() {
        let read = Files::default().read(Path::new("/dev/zero"));
        assert_eq!(read, Err(ResourceError::Other("not a file".to_owned())));
    }
}
