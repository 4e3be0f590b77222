//! What can be wrong with a mesh or with the bytes that should hold one.

use std::fmt;

/// Whose fault a [`MeshError`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshErrorKind {
    /// The bytes do not follow the format.
    Syntax,
    /// A count is larger than this crate handles (more than 2³² − 1 vertices, for instance).
    Limit,
    /// An index refers to something that does not exist.
    OutOfRange,
    /// The input ends before what it announced.
    Truncated,
    /// The input is well formed but uses something that this crate does not read.
    Unsupported,
    /// A coordinate is NaN, infinite, or too large for single precision.
    NonFinite,
    /// The vectors of a [`TriangleMesh`](crate::TriangleMesh) have lengths that do not fit
    /// together.
    Inconsistent,
}

/// A mesh that could not be read or is not valid, with the place where that shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshError {
    /// The class of the error.
    pub kind: MeshErrorKind,
    /// One sentence for people, without the place.
    pub message: String,
    /// The line in text formats, counted from one.
    pub line: Option<u64>,
    /// The byte in binary formats, counted from zero.
    pub offset: Option<u64>,
}

impl MeshError {
    /// An error without a place.
    pub(crate) fn new(kind: MeshErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), line: None, offset: None }
    }

    /// The same error, at this line.
    pub(crate) fn at_line(self, line: u64) -> Self {
        Self { line: Some(line), ..self }
    }

    /// The same error, at this byte.
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
    fn the_place_comes_before_the_message() {
        let error = MeshError::new(MeshErrorKind::Syntax, "bad");
        assert_eq!(error.to_string(), "bad");
        assert_eq!(error.clone().at_line(3).to_string(), "line 3: bad");
        assert_eq!(error.at_offset(9).to_string(), "byte 9: bad");
    }
}
