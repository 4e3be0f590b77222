//! Keeps two processes from writing the same output.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use etendue::durable::folder_of;

use crate::failure::Failure;
use crate::text;

/// A lock on an output file, which ends with this value or with the process.
///
/// The lock is on a hidden file beside the output, because the output itself is replaced. A process
/// that is killed leaves the hidden file behind, but not its lock.
#[derive(Debug)]
pub(crate) struct OutputLock {
    path: PathBuf,
    file: File,
}

/// How often to try: another process may remove the file between opening and locking.
const ATTEMPTS: usize = 10;

impl OutputLock {
    /// Locks an output. `None` where the file system or the folder does not permit locks, which is no
    /// reason not to render.
    pub(crate) fn new(output: &Path) -> Result<Option<Self>, Failure> {
        let path = lock_name(output);
        for _ in 0..ATTEMPTS {
            let opened = File::options().write(true).create(true).truncate(false).open(&path);
            let Ok(file) = opened else { return Ok(None) };
            match file.try_lock() {
                Ok(()) if is_at(&path, &file) => return Ok(Some(Self { path, file })),
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return Err(Failure::failed(format!(
                        "another process is rendering to {}",
                        text::path(output)
                    )));
                }
                Err(TryLockError::Error(_)) => {
                    // Nobody can hold a lock here.
                    let _ = fs::remove_file(&path);
                    return Ok(None);
                }
            }
        }
        Ok(None)
    }
}

impl Drop for OutputLock {
    fn drop(&mut self) {
        // Before the lock ends: afterwards the file may be another process's.
        if is_at(&self.path, &self.file) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// `.NAME.lock` in the folder of the file that is replaced.
fn lock_name(output: &Path) -> PathBuf {
    let target = fs::canonicalize(output);
    let output = target.as_deref().unwrap_or(output);
    let mut name = std::ffi::OsString::from(".");
    name.push(output.file_name().unwrap_or_default());
    name.push(".lock");
    folder_of(output).join(name)
}

/// Whether the file at this path is still the one that was opened.
#[cfg(unix)]
fn is_at(path: &Path, file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    let (named, opened) = (fs::symlink_metadata(path), file.metadata());
    named.is_ok_and(|named| opened.is_ok_and(|opened| identity(named) == identity(opened)))
}

/// Other systems do not remove files that are open.
#[cfg(not(unix))]
fn is_at(path: &Path, _file: &File) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_lock_is_refused_until_the_first_one_ends() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("a.exr");
        let first = OutputLock::new(&output).unwrap();
        assert!(first.is_some());
        let error = OutputLock::new(&output).unwrap_err();
        assert!(error.message.contains("another process is rendering to"), "{}", error.message);
        assert!(OutputLock::new(&folder.path().join("b.exr")).unwrap().is_some());
        drop(first);
        assert!(OutputLock::new(&output).unwrap().is_some());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn an_abandoned_file_does_not_lock_and_a_missing_folder_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(".a.exr.lock"), "").unwrap();
        assert!(OutputLock::new(&folder.path().join("a.exr")).unwrap().is_some());
        assert!(OutputLock::new(&folder.path().join("missing/a.exr")).unwrap().is_none());
    }
}
