//! The dictionary of a serialized file: the offsets of its shapes.

use crate::error::{MeshError, MeshErrorKind};

/// The identifier at the start of every shape.
const IDENTIFIER: u16 = 0x041C;

/// The size of the identifier and the version.
const SHAPE_HEADER_SIZE: usize = 4;

/// The size of the number of shapes at the end of a file.
const COUNT_SIZE: usize = 4;

/// The supported versions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    /// Offsets have 32 bits; shapes have no names.
    Three,
    /// Offsets have 64 bits; shapes have names.
    Four,
}

impl Version {
    fn offset_size(self) -> usize {
        match self {
            Self::Three => 4,
            Self::Four => 8,
        }
    }
}

/// A compressed shape.
#[derive(Debug)]
pub(super) struct Shape<'a> {
    pub(super) version: Version,
    /// The zlib stream; other shapes may follow.
    pub(super) compressed: &'a [u8],
    /// The offset of the stream in the file.
    pub(super) offset: usize,
}

/// The offsets of all shapes.
pub(super) struct Dictionary<'a> {
    /// The file up to the dictionary.
    shapes: &'a [u8],
    offsets: &'a [u8],
    version: Version,
}

impl<'a> Dictionary<'a> {
    /// The dictionary at the end of a file. The version of the first shape determines the size of
    /// its entries.
    pub(super) fn read(bytes: &'a [u8]) -> Result<Self, MeshError> {
        let version = read_shape_header(bytes, 0)?;
        let truncated = || {
            MeshError::new(MeshErrorKind::Truncated, "the file ends before its list of shapes")
                .at_offset(bytes.len())
        };
        let (before_count, count) = bytes.split_last_chunk::<COUNT_SIZE>().ok_or_else(truncated)?;
        let size = u64::from(u32::from_le_bytes(*count)) * version.offset_size() as u64;
        let start =
            usize::try_from(size).ok().and_then(|size| before_count.len().checked_sub(size));
        match start {
            Some(start) if start >= SHAPE_HEADER_SIZE => {
                let (shapes, offsets) = before_count.split_at(start);
                Ok(Self { shapes, offsets, version })
            }
            _ => Err(truncated()),
        }
    }

    /// The number of shapes.
    pub(super) fn shape_count(&self) -> u32 {
        // The count was read from 32 bits.
        (self.offsets.len() / self.version.offset_size()) as u32
    }

    /// The shape with this index.
    pub(super) fn shape(&self, index: u32) -> Result<Shape<'a>, MeshError> {
        let Some(offset) = self.offset(index) else {
            return Err(MeshError::new(
                MeshErrorKind::OutOfRange,
                format!("there is no shape {index}: the file has {}", self.shape_count()),
            ));
        };
        let start = usize::try_from(offset).ok().filter(|&start| start < self.shapes.len());
        let Some(start) = start else {
            return Err(MeshError::new(
                MeshErrorKind::OutOfRange,
                format!("shape {index} starts at byte {offset}, which is outside the shapes"),
            ));
        };
        let version = read_shape_header(self.shapes, start)?;
        let offset = start + SHAPE_HEADER_SIZE;
        Ok(Shape { version, compressed: &self.shapes[offset..], offset })
    }

    fn offset(&self, index: u32) -> Option<u64> {
        let index = index as usize;
        match self.version {
            Version::Three => {
                let offsets = self.offsets.as_chunks::<4>().0;
                offsets.get(index).map(|&offset| u64::from(u32::from_le_bytes(offset)))
            }
            Version::Four => {
                let offsets = self.offsets.as_chunks::<8>().0;
                offsets.get(index).map(|&offset| u64::from_le_bytes(offset))
            }
        }
    }
}

/// Reads the identifier and the version at `start`.
fn read_shape_header(bytes: &[u8], start: usize) -> Result<Version, MeshError> {
    let error = |kind, message: String| Err(MeshError::new(kind, message).at_offset(start));
    let header = bytes.get(start..).and_then(<[u8]>::first_chunk::<SHAPE_HEADER_SIZE>);
    let Some(&[low, high, version_low, version_high]) = header else {
        return error(MeshErrorKind::Truncated, "the file ends before a shape".to_owned());
    };
    let identifier = u16::from_le_bytes([low, high]);
    if identifier != IDENTIFIER {
        return error(
            MeshErrorKind::Syntax,
            format!("a serialized shape starts with {IDENTIFIER:#06x}, not {identifier:#06x}"),
        );
    }
    match u16::from_le_bytes([version_low, version_high]) {
        3 => Ok(Version::Three),
        4 => Ok(Version::Four),
        other => error(
            MeshErrorKind::Unsupported,
            format!("version {other} of the serialized format is not supported, only 3 and 4"),
        ),
    }
}
