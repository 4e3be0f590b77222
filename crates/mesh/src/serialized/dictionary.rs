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
    /// The size of an offset in bytes.
    offset_size: usize,
    /// Whether the file has a dictionary; without one, only the first shape is known.
    is_found: bool,
}

impl<'a> Dictionary<'a> {
    /// The dictionary at the end of a file. The version of the first shape determines the size of
    /// its entries; some writers use the size of the other version. A file without a dictionary
    /// has one shape.
    pub(super) fn read(bytes: &'a [u8]) -> Result<Self, MeshError> {
        let version = read_shape_header(bytes, 0)?;
        let [own, other] = match version {
            Version::Three => [4, 8],
            Version::Four => [8, 4],
        };
        let found =
            [own, other].into_iter().find_map(|offset_size| Self::at_end(bytes, offset_size));
        Ok(found.unwrap_or(Self { shapes: bytes, offsets: &[], offset_size: own, is_found: false }))
    }

    /// The dictionary with offsets of this size, if all of them lead to shapes.
    fn at_end(bytes: &'a [u8], offset_size: usize) -> Option<Self> {
        let (before_count, count) = bytes.split_last_chunk::<COUNT_SIZE>()?;
        let size = (u32::from_le_bytes(*count) as usize).checked_mul(offset_size)?;
        let start = before_count.len().checked_sub(size)?;
        if size == 0 || start < SHAPE_HEADER_SIZE {
            return None;
        }
        let (shapes, offsets) = before_count.split_at(start);
        let found = Self { shapes, offsets, offset_size, is_found: true };
        let leads_to_shape = |index| {
            found.offset(index).is_some_and(|start| read_shape_header(shapes, start).is_ok())
        };
        (0..found.shape_count()).all(leads_to_shape).then_some(found)
    }

    /// Whether the file has a dictionary.
    pub(super) fn is_found(&self) -> bool {
        self.is_found
    }

    /// The number of shapes.
    pub(super) fn shape_count(&self) -> u32 {
        if !self.is_found {
            return 1;
        }
        // The count was read from 32 bits.
        (self.offsets.len() / self.offset_size) as u32
    }

    /// The shape with this index.
    pub(super) fn shape(&self, index: u32) -> Result<Shape<'a>, MeshError> {
        let Some(start) = self.offset(index) else {
            let message = if self.is_found {
                format!("there is no shape {index}: the file has {}", self.shape_count())
            } else {
                format!("there is no shape {index}: the file has no list of its shapes")
            };
            return Err(MeshError::new(MeshErrorKind::OutOfRange, message));
        };
        let version = read_shape_header(self.shapes, start)?;
        let offset = start + SHAPE_HEADER_SIZE;
        Ok(Shape { version, compressed: &self.shapes[offset..], offset })
    }

    /// The offset of the shape with this index.
    fn offset(&self, index: u32) -> Option<usize> {
        if !self.is_found {
            return (index == 0).then_some(0);
        }
        let start = (index as usize).checked_mul(self.offset_size)?;
        let entry = self.offsets.get(start..)?.get(..self.offset_size)?;
        let offset = match *entry {
            [a, b, c, d] => u64::from(u32::from_le_bytes([a, b, c, d])),
            [a, b, c, d, e, f, g, h] => u64::from_le_bytes([a, b, c, d, e, f, g, h]),
            _ => return None,
        };
        usize::try_from(offset).ok().filter(|start| *start < self.shapes.len())
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
            format!("expected a serialized shape, which starts with {IDENTIFIER:#06x}"),
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
