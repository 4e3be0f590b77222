//! What the writer and the reader of a film's file agree on.

/// The first bytes of every file.
pub(super) const MAGIC: &[u8; 12] = b"etendue sums";

/// The version of the format that is written, and the only one that is read.
pub(super) const VERSION: u32 = 2;

/// Bytes of the checksum.
pub(super) const CHECKSUM_BYTES: usize = 32;

/// Bytes of magic, version and the header's length.
pub(super) const PREFIX_BYTES: usize = MAGIC.len() + 8;

/// What a film's file says beside its sums.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilmRecord {
    /// Everything that decides the picture, by name. Films may be merged only if all are equal.
    pub identity: Vec<(String, String)>,
    /// What else there is to know, by name, such as how to write the picture.
    pub notes: Vec<(String, String)>,
    /// Samples per pixel that the whole picture is planned to have.
    pub planned_samples: u32,
    /// Wall time that the samples took so far.
    pub seconds: f64,
}
