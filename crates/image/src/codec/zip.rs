//! ZIP archives, as far as NumPy uses them: files that are stored or deflated, below 4 GiB.

use std::io::Read;

use flate2::Crc;
use flate2::read::DeflateDecoder;

use crate::{ImageError, Limits};

/// The format's name in messages.
const FORMAT: &str = "ZIP";

const LOCAL_MAGIC: u32 = 0x0403_4b50;
const CENTRAL_MAGIC: u32 = 0x0201_4b50;
const END_MAGIC: u32 = 0x0605_4b50;

const LOCAL_BYTES: usize = 30;
const CENTRAL_BYTES: usize = 46;
const END_BYTES: usize = 22;

/// The most that deflate expands.
const MAX_EXPANSION: u64 = 1032;

/// The date 1980-01-01, the earliest that the format has: files do not depend on the time.
const DATE: u16 = 1 << 5 | 1;

/// Names and contents of the files in an archive. Together they stay within the limit of bytes.
pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Vec<(String, Vec<u8>)>, ImageError> {
    let entries = entries(bytes)?;
    let total = entries.iter().fold(0_u64, |total, entry| total.saturating_add(entry.size.into()));
    if total > limits.bytes {
        let (what, allowed) = ("bytes", limits.bytes);
        return Err(ImageError::TooLarge { what, requested: total, allowed });
    }
    entries.into_iter().map(|entry| Ok((entry.name.clone(), entry.unpack(bytes)?))).collect()
}

/// The start of a file in an archive.
pub(super) struct FileStart {
    pub(super) name: String,
    /// The size of the file, as the directory says.
    pub(super) size: u64,
    /// Its first bytes.
    pub(super) start: Vec<u8>,
}

/// Reads the first bytes of all files, at most `count` of each.
pub(super) fn read_starts(bytes: &[u8], count: usize) -> Result<Vec<FileStart>, ImageError> {
    let start = |entry: Entry| FileStart {
        size: entry.size.into(),
        start: entry.unpack_start(bytes, count),
        name: entry.name,
    };
    Ok(entries(bytes)?.into_iter().map(start).collect())
}

/// The directory.
fn entries(bytes: &[u8]) -> Result<Vec<Entry>, ImageError> {
    let malformed = || ImageError::malformed(FORMAT, "its directory is not valid");
    let end = find_end(bytes).ok_or_else(malformed)?;
    let count = short(bytes, end + 10).ok_or_else(malformed)?;
    let mut at = long(bytes, end + 16).ok_or_else(malformed)? as usize;
    let mut entries = Vec::new();
    for _ in 0..count {
        let entry = Entry::read(bytes, at).ok_or_else(malformed)?;
        at = entry.next;
        entries.push(entry);
    }
    Ok(entries)
}

/// An archive of stored files.
pub(super) fn write(files: &[(String, Vec<u8>)]) -> Result<Vec<u8>, ImageError> {
    let mut archive = Vec::new();
    let mut directory = Vec::new();
    for (name, content) in files {
        let offset = small(archive.len())?;
        let mut checksum = Crc::new();
        checksum.update(content);
        let common = Common { checksum: checksum.sum(), size: small(content.len())?, name };
        archive.extend_from_slice(&LOCAL_MAGIC.to_le_bytes());
        common.push(&mut archive);
        archive.extend_from_slice(name.as_bytes());
        archive.extend_from_slice(content);
        directory.extend_from_slice(&CENTRAL_MAGIC.to_le_bytes());
        directory.extend_from_slice(&VERSION.to_le_bytes());
        common.push(&mut directory);
        // Comment, disk and attributes.
        directory.extend_from_slice(&[0; 10]);
        directory.extend_from_slice(&offset.to_le_bytes());
        directory.extend_from_slice(name.as_bytes());
    }
    let start = small(archive.len())?;
    let length = small(directory.len())?;
    let count = u16::try_from(files.len()).map_err(|_| too_large())?;
    archive.append(&mut directory);
    archive.extend_from_slice(&END_MAGIC.to_le_bytes());
    archive.extend_from_slice(&[0; 4]);
    archive.extend_from_slice(&count.to_le_bytes());
    archive.extend_from_slice(&count.to_le_bytes());
    archive.extend_from_slice(&length.to_le_bytes());
    archive.extend_from_slice(&start.to_le_bytes());
    archive.extend_from_slice(&[0; 2]);
    Ok(archive)
}

/// The version of the format that reads a file.
const VERSION: u16 = 20;

/// What both headers of a stored file have in common.
struct Common<'a> {
    checksum: u32,
    size: u32,
    name: &'a str,
}

impl Common<'_> {
    fn push(&self, bytes: &mut Vec<u8>) {
        // Version, flag for UTF-8, method, time, date.
        for number in [VERSION, 1 << 11, 0, 0, DATE] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        for number in [self.checksum, self.size, self.size] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        // The names are those of layers.
        bytes.extend_from_slice(&(self.name.len() as u16).to_le_bytes());
        bytes.extend_from_slice(&0_u16.to_le_bytes());
    }
}

/// A file as the directory describes it.
struct Entry {
    name: String,
    method: u16,
    checksum: u32,
    packed_size: u32,
    size: u32,
    local: usize,
    /// The place of the next entry.
    next: usize,
}

impl Entry {
    fn read(bytes: &[u8], at: usize) -> Option<Self> {
        if long(bytes, at)? != CENTRAL_MAGIC {
            return None;
        }
        let length = |offset| Some(usize::from(short(bytes, at + offset)?));
        let name_length = length(28)?;
        let name = bytes.get(at + CENTRAL_BYTES..)?.get(..name_length)?;
        Some(Self {
            name: String::from_utf8_lossy(name).into_owned(),
            method: short(bytes, at + 10)?,
            checksum: long(bytes, at + 16)?,
            packed_size: long(bytes, at + 20)?,
            size: long(bytes, at + 24)?,
            local: long(bytes, at + 42)? as usize,
            next: at + CENTRAL_BYTES + name_length + length(30)? + length(32)?,
        })
    }

    fn unpack(&self, bytes: &[u8]) -> Result<Vec<u8>, ImageError> {
        let malformed =
            |what: &str| ImageError::malformed(FORMAT, format!("`{}`: {what}", self.name));
        if self.packed_size == u32::MAX || self.size == u32::MAX {
            return Err(ImageError::unsupported(FORMAT, "files of 4 GiB and more"));
        }
        let packed = self.packed(bytes).ok_or_else(|| malformed("it lies outside of the file"))?;
        let possible = u64::from(self.packed_size).saturating_mul(MAX_EXPANSION);
        let content = match self.method {
            0 if self.size == self.packed_size => packed.to_vec(),
            8 if u64::from(self.size) <= possible => {
                let mut content = Vec::with_capacity(self.size as usize);
                // One byte more, to notice data that is too long.
                let mut decoder = DeflateDecoder::new(packed).take(u64::from(self.size) + 1);
                let read = decoder.read_to_end(&mut content);
                read.map_err(|error| malformed(&error.to_string()))?;
                content
            }
            0 | 8 => return Err(malformed("its size is not valid")),
            method => return Err(ImageError::unsupported(FORMAT, format!("method {method}"))),
        };
        let mut checksum = Crc::new();
        checksum.update(&content);
        if content.len() != self.size as usize || checksum.sum() != self.checksum {
            return Err(malformed("its checksum is wrong"));
        }
        Ok(content)
    }

    /// The first bytes, at most `count`; fewer where the file is damaged.
    fn unpack_start(&self, bytes: &[u8], count: usize) -> Vec<u8> {
        let packed = self.packed(bytes).unwrap_or_default();
        if self.method == 0 {
            return packed[..packed.len().min(count)].to_vec();
        }
        let mut start = Vec::new();
        let mut decoder = DeflateDecoder::new(packed).take(count as u64);
        // What was read before an error stays.
        let _ = decoder.read_to_end(&mut start);
        start
    }

    /// The bytes that follow the local header, whose name and extra field may have other lengths than
    /// those of the directory.
    fn packed<'a>(&self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        if long(bytes, self.local)? != LOCAL_MAGIC {
            return None;
        }
        let length = |offset| Some(usize::from(short(bytes, self.local + offset)?));
        let start = self.local + LOCAL_BYTES + length(26)? + length(28)?;
        bytes.get(start..)?.get(..self.packed_size as usize)
    }
}

/// The place of the last record, which a comment of up to 64 KiB may follow.
fn find_end(bytes: &[u8]) -> Option<usize> {
    let last = bytes.len().checked_sub(END_BYTES)?;
    let first = last.saturating_sub(usize::from(u16::MAX));
    (first..=last).rev().find(|at| long(bytes, *at) == Some(END_MAGIC))
}

fn short(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|bytes| u16::from_le_bytes(*bytes))
}

fn long(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|bytes| u32::from_le_bytes(*bytes))
}

fn small(size: usize) -> Result<u32, ImageError> {
    u32::try_from(size).ok().filter(|size| *size < u32::MAX).ok_or_else(too_large)
}

fn too_large() -> ImageError {
    ImageError::invalid_picture("the archive would take 4 GiB or more")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files() -> Vec<(String, Vec<u8>)> {
        vec![("a.npy".to_owned(), b"hello".to_vec()), ("ü".to_owned(), Vec::new())]
    }

    #[test]
    fn archives_round_trip() {
        let archive = write(&files()).unwrap();
        assert_eq!(read(&archive, &Limits::default()).unwrap(), files());
        let limits = Limits { bytes: 4, ..Limits::default() };
        assert!(matches!(read(&archive, &limits), Err(ImageError::TooLarge { .. })));
    }

    #[test]
    fn deflated_files_are_read() {
        let archive = deflated();
        let read = read(&archive, &Limits::default()).unwrap();
        assert_eq!(read, [("x.txt".to_owned(), b"a".repeat(40))]);
    }

    /// An archive of `x.txt`, forty times `a`, deflated.
    fn deflated() -> Vec<u8> {
        use std::io::Write;
        let content = b"a".repeat(40);
        let mut encoder =
            flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(&content).unwrap();
        let packed = encoder.finish().unwrap();
        let mut archive = write(&[("x.txt".to_owned(), packed.clone())]).unwrap();
        let mut checksum = Crc::new();
        checksum.update(&content);
        let central = LOCAL_BYTES + 5 + packed.len();
        for start in [0, central + 2] {
            archive[start + 8] = 8;
            archive[start + 14..start + 18].copy_from_slice(&checksum.sum().to_le_bytes());
            archive[start + 22] = 40;
        }
        archive
    }

    #[test]
    fn every_cut_and_every_changed_byte_is_an_error_or_harmless() {
        for archive in [write(&files()).unwrap(), deflated()] {
            for length in 0..archive.len() {
                assert!(read(&archive[..length], &Limits::default()).is_err(), "{length}");
            }
            for index in 0..archive.len() {
                for value in [0, 0x7f, 0xff] {
                    let mut changed = archive.clone();
                    changed[index] = value;
                    // No panic, and no more than the content.
                    let found = read(&changed, &Limits::default()).unwrap_or_default();
                    assert!(found.iter().all(|(_, content)| content.len() <= 40));
                }
            }
        }
    }
}
