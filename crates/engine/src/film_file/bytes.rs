//! Numbers and texts as bytes, with a checksum of all bytes.

use std::io::{self, Read, Write};

use super::error::FilmFileError;

/// Writes bytes and hashes them.
pub(super) struct HashingWriter<'a> {
    pub(super) inner: &'a mut dyn Write,
    pub(super) hasher: blake3::Hasher,
}

impl HashingWriter<'_> {
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hasher.update(bytes);
        self.inner.write_all(bytes)
    }
}

/// Reads bytes, hashes them, and knows how many are left.
pub(super) struct HashingReader<'a> {
    pub(super) inner: &'a mut dyn Read,
    pub(super) hasher: blake3::Hasher,
    /// Bytes that are left, by the length of the file.
    pub(super) left: u64,
}

impl HashingReader<'_> {
    /// The next bytes. They are never more than are left, so that memory stays within the file's
    /// length.
    pub(super) fn read(&mut self, count: u64) -> Result<Vec<u8>, FilmFileError> {
        self.left = self.left.checked_sub(count).ok_or(FilmFileError::Torn)?;
        let mut bytes = vec![0; usize::try_from(count).map_err(|_| FilmFileError::Torn)?];
        self.inner.read_exact(&mut bytes)?;
        self.hasher.update(&bytes);
        Ok(bytes)
    }
}

/// Takes numbers and texts from the front of some bytes.
pub(super) struct Cursor<'a>(pub(super) &'a [u8]);

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], FilmFileError> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(ENDS_EARLY)?;
        self.0 = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], FilmFileError> {
        let (taken, rest) = self.0.split_first_chunk().ok_or(ENDS_EARLY)?;
        self.0 = rest;
        Ok(*taken)
    }

    pub(super) fn u8(&mut self) -> Result<u8, FilmFileError> {
        self.array::<1>().map(|[byte]| byte)
    }

    pub(super) fn u16(&mut self) -> Result<u16, FilmFileError> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, FilmFileError> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Result<u64, FilmFileError> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn i64(&mut self) -> Result<i64, FilmFileError> {
        self.array().map(i64::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Result<f64, FilmFileError> {
        self.array().map(f64::from_le_bytes)
    }

    pub(super) fn text(&mut self) -> Result<String, FilmFileError> {
        let length = self.u32()? as usize;
        let bytes = self.take(length)?.to_vec();
        String::from_utf8(bytes).map_err(|_| FilmFileError::Invalid("a text is not UTF-8"))
    }

    /// A list whose items take at least one byte each: its length is checked against the bytes left.
    pub(super) fn list<T>(
        &mut self,
        item: impl Fn(&mut Self) -> Result<T, FilmFileError>,
    ) -> Result<Vec<T>, FilmFileError> {
        let count = self.u32()? as usize;
        if count > self.0.len() {
            return Err(ENDS_EARLY);
        }
        (0..count).map(|_| item(self)).collect()
    }
}

const ENDS_EARLY: FilmFileError = FilmFileError::Invalid("a part ends early");

/// Appends a text to bytes.
pub(super) fn push_text(bytes: &mut Vec<u8>, text: &str) {
    push_length(bytes, text.len());
    bytes.extend_from_slice(text.as_bytes());
}

/// Appends the length of a text or list. All of them are far below the limit: names, the options of
/// one command line, eight defects.
pub(super) fn push_length(bytes: &mut Vec<u8>, length: usize) {
    bytes.extend_from_slice(&u32::try_from(length).unwrap_or(u32::MAX).to_le_bytes());
}
