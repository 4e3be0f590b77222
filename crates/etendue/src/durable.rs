//! Atomic, durable file writes: a file is complete or absent even if the process is killed or the
//! machine stops.
#![allow(
    clippy::disallowed_methods,
    reason = "hosts choose this module when they want files to be written; nothing else calls it"
)]

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// How far a write has progressed. A process may be killed after any of these steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WriteStep {
    /// The temporary file exists and is empty.
    Created,
    /// The operating system has received all bytes.
    Written,
    /// All bytes are on disk.
    Synced,
    /// The file has been renamed.
    Renamed,
    /// The rename is on disk.
    Done,
}

/// Writes a temporary file next to the target, syncs it to disk, renames it, and syncs the rename.
/// At every moment the file is either unchanged or complete.
///
/// # Errors
///
/// Returns the operating system's error; the file is then unchanged.
pub fn write_durably(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    write_durably_with(path, write, &|_| {})
}

/// Like [`write_durably`], but calls `reached` after every step, so that tests can end the process
/// there.
///
/// # Errors
///
/// Same as [`write_durably`].
pub fn write_durably_with(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    reached: &dyn Fn(WriteStep),
) -> io::Result<()> {
    // Where a link stands, the file that it names is replaced.
    let target = fs::canonicalize(path);
    let path = target.as_deref().unwrap_or(path);
    let temporary = temporary_name(path);
    let written = write_temporary(&temporary, write, reached).and_then(|()| {
        fs::rename(&temporary, path)?;
        reached(WriteStep::Renamed);
        Ok(())
    });
    if let Err(error) = written {
        // Report the first error.
        let _ = fs::remove_file(&temporary);
        return Err(error);
    }
    sync_folder(path)?;
    reached(WriteStep::Done);
    Ok(())
}

fn write_temporary(
    temporary: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    reached: &dyn Fn(WriteStep),
) -> io::Result<()> {
    /// Large chunks need few calls.
    const BUFFER_BYTES: usize = 1 << 20;

    let file = File::create_new(temporary)?;
    // While the lock is held, no other process treats the file as abandoned. Some file systems do
    // not support locks.
    let _ = file.try_lock();
    reached(WriteStep::Created);
    let mut buffer = BufWriter::with_capacity(BUFFER_BYTES, file);
    write(&mut buffer)?;
    let file = buffer.into_inner().map_err(io::IntoInnerError::into_error)?;
    reached(WriteStep::Written);
    file.sync_all()?;
    reached(WriteStep::Synced);
    Ok(())
}

/// The file that a name stands for: where symbolic links lead, whether or not there is a file yet.
///
/// # Errors
///
/// The operating system's error, or one about links that lead nowhere.
pub fn follow_links(path: &Path) -> io::Result<PathBuf> {
    /// As many as Linux follows.
    const MAX_LINKS: usize = 40;

    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::symlink_metadata(&path) {
            Ok(metadata) if metadata.is_symlink() => {
                path = folder_of(&path).join(fs::read_link(&path)?);
            }
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => return Ok(path),
        }
    }
    Err(io::Error::other("its symbolic links lead in a circle"))
}

/// Deletes a file durably; a missing file is not an error.
///
/// # Errors
///
/// Returns the operating system's error.
pub fn remove_durably(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        Err(_) => Ok(()),
        Ok(()) => sync_folder(path),
    }
}

/// Deletes temporary files of `path` left by killed processes. Files still being written stay.
/// Failures are ignored.
pub fn remove_abandoned(path: &Path) {
    let start = temporary_start(path);
    for entry in fs::read_dir(folder_of(path)).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let bytes = name.as_encoded_bytes();
        let is_ours = bytes.starts_with(start.as_encoded_bytes()) && bytes.ends_with(b".tmp");
        // Opening a pipe would wait for somebody to write to it.
        let is_file = || entry.file_type().is_ok_and(|kind| kind.is_file());
        let is_abandoned = || File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
        if is_ours && is_file() && is_abandoned() {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Syncs the folder of a file to disk.
fn sync_folder(path: &Path) -> io::Result<()> {
    // Other systems cannot open folders and persist names themselves.
    if cfg!(unix) { File::open(folder_of(path))?.sync_all() } else { Ok(()) }
}

/// The folder that contains a file.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// A hidden name in the file's folder that no other process on this machine uses.
pub fn temporary_name(path: &Path) -> PathBuf {
    let mut name = temporary_start(path);
    name.push(format!("{}.tmp", std::process::id()));
    path.with_file_name(name)
}

fn temporary_start(path: &Path) -> OsString {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".");
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn temporary_names_lie_beside_their_files() {
        let name = temporary_name(Path::new("folder/a.exr"));
        assert_eq!(name.parent(), Some(Path::new("folder")));
        assert_ne!(name.extension(), Some("exr".as_ref()));
        assert_eq!(temporary_name(Path::new("a.exr")).parent(), Some(Path::new("")));
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let occupied = folder.path().join("occupied");
        fs::create_dir(&occupied).unwrap();
        fs::write(occupied.join("inside"), "x").unwrap();
        let written = write_durably(&occupied, |out| out.write_all(b"new"));
        assert!(written.is_err(), "a folder cannot be replaced by a file");
        let file = folder.path().join("file");
        fs::write(&file, "old").unwrap();
        let full = |out: &mut dyn Write| {
            out.write_all(&[0; 3 << 20])?;
            Err(io::ErrorKind::StorageFull.into())
        };
        assert_eq!(write_durably(&file, full).unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert_eq!(fs::read(&file).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn abandoned_files_go_and_those_in_use_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in [".a.exr.1.tmp", ".a.exr.2.tmp", ".b.exr.1.tmp", "a.exr"] {
            fs::write(path(name), "x").unwrap();
        }
        let in_use = File::open(path(".a.exr.2.tmp")).unwrap();
        in_use.try_lock().unwrap();
        remove_abandoned(&path("a.exr"));
        assert!(!path(".a.exr.1.tmp").exists());
        assert!(path(".a.exr.2.tmp").exists());
        assert!(path(".b.exr.1.tmp").exists() && path("a.exr").exists());
    }

    #[test]
    fn the_steps_come_in_order_and_the_file_is_whole_from_the_fourth_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "old").unwrap();
        let steps = std::cell::RefCell::new(Vec::new());
        let reached = |step: WriteStep| {
            let expected: &[u8] = if step < WriteStep::Renamed { b"old" } else { b"new" };
            assert_eq!(fs::read(&path).unwrap(), expected, "{step:?}");
            steps.borrow_mut().push(step);
        };
        write_durably_with(&path, |out| out.write_all(b"new"), &reached).unwrap();
        use WriteStep::{Created, Done, Renamed, Synced, Written};
        assert_eq!(steps.into_inner(), [Created, Written, Synced, Renamed, Done]);
    }
}
