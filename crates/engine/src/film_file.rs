//! Film sums as bytes: checkpoints of a render, and parts of a picture to be merged.
//!
//! # Layout
//!
//! All numbers are little-endian; a text is its length in bytes as `u32`, and that many bytes of
//! UTF-8; a list is its length as `u32`, and its items.
//!
//! | what | how |
//! |---|---|
//! | magic | the 12 bytes `etendue sums` |
//! | version of the format | `u32`, today 1 |
//! | length of the header | `u32` |
//! | header | see below |
//! | tiles | along the Morton curve of the region's tiles, see below |
//! | splats | if there are any: row by row the sums of red, green and blue of each pixel |
//! | checksum | 32 bytes: BLAKE3 of everything before |
//!
//! The header: the list of what decides the picture and the list of notes, each of pairs of texts;
//! planned samples `u32`; seconds `f64`; region as four `u32`; first sample `u32`; samples that
//! every pixel has at least, `u32`; side of tiles `u32`; whether there are squares and whether
//! there are splats, `u8` each; the list of the layers' names.
//!
//! A tile: the index of the next sample `u32`; defects of two kinds, `u64` each; the list of the
//! first of them, each index, y, x as `u32` and kind as `u8`; the count of each pixel `u32`; then the
//! sums of each channel of each pixel, and the squares. Sums: the window of each as `u16`, then the two
//! digits of each as `i64` (`exact_sums`).
//!
//! Sums of noise do not compress, so nothing is compressed.

mod bytes;
mod error;
mod read;
mod write;

pub use error::FilmFileError;
pub use read::FilmFile;

/// What every file begins with.
const MAGIC: &[u8; 12] = b"etendue sums";

/// The version of the format that is written, and the only one that is read.
const VERSION: u32 = 1;

/// Bytes of the checksum.
const CHECKSUM_BYTES: usize = 32;

/// Bytes of magic, version and the header's length.
const PREFIX_BYTES: usize = MAGIC.len() + 8;

/// What a film's file says beside its sums.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilmRecord {
    /// Everything that decides the picture, by name. Films belong together only if all are equal.
    pub identity: Vec<(String, String)>,
    /// What else there is to know, by name, such as how the picture is to be written.
    pub notes: Vec<(String, String)>,
    /// Samples per pixel that the whole picture is planned to have.
    pub planned_samples: u32,
    /// Wall time that the samples took so far.
    pub seconds: f64,
}
