//! Film sums as bytes: checkpoints of a render, and parts of a picture to be merged.
//!
//! # Layout
//!
//! Numbers are little-endian. A text is its length in bytes as `u32`, then its bytes in UTF-8. A list
//! is its length as `u32`, then its items.
//!
//! | part | content |
//! |---|---|
//! | magic | the 12 bytes `etendue sums` |
//! | version of the format | `u32`, today 2 |
//! | length of the header | `u32` |
//! | header | see below |
//! | tiles | along the Morton curve of the region's tiles, see below |
//! | splats | if the film has them: row by row, the sums of red, green and blue of each pixel |
//! | checksum | 32 bytes: BLAKE3 of all bytes before |
//!
//! The header: the list of what decides the picture and the list of notes, each of pairs of texts;
//! planned samples `u32`; seconds `f64`; region as four `u32`; first sample `u32`; the least number of
//! samples of any pixel `u32`; side of tiles `u32`; whether samples with odd index are summed apart too
//! and whether there are splats, `u8` each; the list of the channels' names, and the list of their kinds
//! as `u8`: 0 for means, 1 for the value of the sample nearest to a pixel's centre.
//!
//! A tile: the index of the next sample `u32`; the counts of the two kinds of defects, `u64` each; the
//! list of the first defects, each with index, y and x as `u32` and its kind as `u8`; the count of each
//! pixel `u32`, and of its samples with odd index if these are summed apart; the sums of each channel of
//! each pixel; the sums of red, green and blue of the samples with odd index. Sums are stored as the
//! window of each as `u16`, then the two digits of each as `i64` (`exact_sums`). If there are channels of
//! the nearest sample, they follow for each pixel: the squared distance as the bits of an `f32`, the
//! index `u32`, and the values as `f32`.
//!
//! Nothing is compressed, because the sums are noise.

mod bytes;
mod error;
mod format;
mod read;
mod write;

pub use error::FilmFileError;
pub use format::FilmRecord;
pub use read::FilmFile;
