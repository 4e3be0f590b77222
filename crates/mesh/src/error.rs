//! Mesh errors.

use std::fmt;

/// The class of a [`MeshError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshErrorKind {
    /// The bytes do not follow the format.
    Syntax,
    /// A count exceeds the limits of this crate (for example, more than 2³² − 2 vertices).
    Limit,
    /// An index refers to something that does not exist.
    OutOfRange,
    /// The input ends before the announced data.
    Truncated,
    /// The input is well formed but uses a feature that this crate does not support.
    Unsupported,
    /// A coordinate is NaN, infinite, or too large for single precision.
    NonFinite,
    /// The arrays of a [`TriangleMesh`](crate::TriangleMesh) have inconsistent lengths.
    Inconsistent,
}

/// A mesh that cannot be read or is not valid, with the location of the error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshError {
    /// The class of the error.
    pub kind: MeshErrorKind,
    /// One sentence, without the location.
    pub message: String,
    /// The line in text formats, starting at one.
    pub line: Option<u64>,
    /// The byte offset in binary formats.
    pub offset: Option<u64>,
}

impl MeshError {
    /// An error without a location.
    pub(crate) fn new(kind: MeshErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), line: None, offset: None }
    }

    /// The same error, at a line.
    pub(crate) fn at_line(self, line: u64) -> Self {
        Self { line: Some(line), ..self }
    }

    /// The same error, at a byte offset.
    pub(crate) fn at_offset(self, offset: usize) -> Self {
        Self { offset: Some(offset as u64), ..self }
    }
}

impl fmt::Display for MeshError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(formatter, "line {line}: ")?;
        } else if let Some(offset) = self.offset {
            write!(formatter, "byte {offset}: ")?;
        }
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for MeshError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_location_precedes_the_message() {
        let error = MeshError::new(MeshErrorKind::Syntax, "bad");
        assert_eq!(error.to_string(), "bad");
        assert_eq!(error.clone().at_line(3).to_string(), "line 3: bad");
        assert_eq!(error.at_offset(9).to_string(), "byte 9: bad");
    }
}
