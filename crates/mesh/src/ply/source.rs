//! The data of a PLY file as a sequence of numbers, independent of the encoding.

use super::header::{Element, Property};
use super::scalar::{ByteOrder, ScalarType};
use crate::error::{MeshError, MeshErrorKind};
use crate::text::TextCursor;

/// A sequence of numbers.
pub(super) trait Source {
    /// The next number, in single precision.
    fn number(&mut self, kind: ScalarType) -> Result<f32, MeshError>;

    /// The next number, which must be an integer.
    fn integer(&mut self, kind: ScalarType) -> Result<i64, MeshError>;

    /// Skips `count` numbers.
    fn skip_numbers(&mut self, kind: ScalarType, count: usize) -> Result<(), MeshError>;

    /// The minimum size of a number in bytes.
    fn min_size(kind: ScalarType) -> usize;

    /// The number of remaining bytes.
    fn bytes_left(&self) -> usize;

    /// Consumes all rows of an element without lists at once, if the encoding allows it.
    fn take_rows(&mut self, element: &Element) -> Option<(&[u8], ByteOrder)>;

    /// An error at the current position.
    fn error(&self, kind: MeshErrorKind, message: String) -> MeshError;

    /// Rejects an element that announces more rows than the rest of the file can hold.
    fn check_room(&self, element: &Element) -> Result<(), MeshError> {
        let min_size = |property: &Property| {
            Self::min_size(property.list_count.unwrap_or(property.value)) as u128
        };
        let row_size: u128 = element.properties.iter().map(min_size).sum();
        if u128::from(element.row_count) * row_size <= self.bytes_left() as u128 {
            return Ok(());
        }
        Err(self.error(
            MeshErrorKind::Truncated,
            format!(
                "the header announces {} rows of element `{}`, but only {} bytes are left",
                element.row_count,
                element.name.escape_debug(),
                self.bytes_left()
            ),
        ))
    }

    /// The length of the list that starts here.
    fn list_length(&mut self, property: &Property, count: ScalarType) -> Result<usize, MeshError> {
        let written = self.integer(count)?;
        let length = usize::try_from(written).map_err(|_| {
            self.error(MeshErrorKind::Syntax, format!("a list cannot have {written} entries"))
        })?;
        if length.saturating_mul(Self::min_size(property.value)) <= self.bytes_left() {
            return Ok(length);
        }
        Err(self.error(
            MeshErrorKind::Truncated,
            format!("a list of {length} entries does not fit in the rest of the file"),
        ))
    }

    /// Skips a list.
    fn skip_list(&mut self, property: &Property, count: ScalarType) -> Result<(), MeshError> {
        let length = self.list_length(property, count)?;
        self.skip_numbers(property.value, length)
    }

    /// Skips all rows of an element.
    fn skip(&mut self, element: &Element) -> Result<(), MeshError> {
        if element.properties.is_empty() || self.take_rows(element).is_some() {
            return Ok(());
        }
        for _ in 0..element.row_count {
            for property in &element.properties {
                match property.list_count {
                    None => self.skip_numbers(property.value, 1)?,
                    Some(count) => self.skip_list(property, count)?,
                }
            }
        }
        Ok(())
    }
}

/// Binary numbers.
pub(super) struct BinarySource<'a> {
    left: &'a [u8],
    /// The offset in the file where `left` ends.
    end: usize,
    order: ByteOrder,
}

impl<'a> BinarySource<'a> {
    /// The numbers in `body`, which starts at `offset` in its file.
    pub(super) fn new(body: &'a [u8], offset: usize, order: ByteOrder) -> Self {
        Self { left: body, end: offset + body.len(), order }
    }

    #[cold]
    fn truncated(&self) -> MeshError {
        self.error(MeshErrorKind::Truncated, "the file ends within its data".to_owned())
    }
}

impl Source for BinarySource<'_> {
    #[inline]
    fn number(&mut self, kind: ScalarType) -> Result<f32, MeshError> {
        let value = kind.read_float(self.left, self.order).ok_or_else(|| self.truncated())?;
        self.left = &self.left[kind.size()..];
        Ok(value)
    }

    #[inline]
    fn integer(&mut self, kind: ScalarType) -> Result<i64, MeshError> {
        let value = kind.read_integer(self.left, self.order).ok_or_else(|| self.truncated())?;
        self.left = &self.left[kind.size()..];
        Ok(value)
    }

    fn skip_numbers(&mut self, kind: ScalarType, count: usize) -> Result<(), MeshError> {
        let size = count.checked_mul(kind.size());
        let left = size.and_then(|size| self.left.get(size..));
        self.left = left.ok_or_else(|| self.truncated())?;
        Ok(())
    }

    fn min_size(kind: ScalarType) -> usize {
        kind.size()
    }

    fn bytes_left(&self) -> usize {
        self.left.len()
    }

    fn take_rows(&mut self, element: &Element) -> Option<(&[u8], ByteOrder)> {
        if !element.is_fixed() {
            return None;
        }
        let row_count = usize::try_from(element.row_count).ok()?;
        let size = row_count.checked_mul(element.min_row_size())?;
        let (rows, left) = self.left.split_at_checked(size)?;
        self.left = left;
        Some((rows, self.order))
    }

    #[cold]
    fn error(&self, kind: MeshErrorKind, message: String) -> MeshError {
        MeshError::new(kind, message).at_offset(self.end - self.left.len())
    }
}

/// Numbers in text, separated by blanks or line ends, which are equivalent.
pub(super) struct AsciiSource<'a> {
    cursor: TextCursor<'a>,
}

impl<'a> AsciiSource<'a> {
    /// The numbers from the cursor on.
    pub(super) fn new(cursor: TextCursor<'a>) -> Self {
        Self { cursor }
    }

    #[inline]
    fn skip_to_number(&mut self) -> Result<(), MeshError> {
        loop {
            self.cursor.skip_blanks();
            match self.cursor.peek() {
                Some(b'\n' | b'\r') => self.cursor.take_line_end(),
                Some(_) => return Ok(()),
                None => {
                    return Err(self
                        .cursor
                        .error(MeshErrorKind::Truncated, "the file ends within its data"));
                }
            }
        }
    }
}

impl Source for AsciiSource<'_> {
    #[inline]
    fn number(&mut self, _: ScalarType) -> Result<f32, MeshError> {
        self.skip_to_number()?;
        self.cursor.float("a number")
    }

    #[inline]
    fn integer(&mut self, _: ScalarType) -> Result<i64, MeshError> {
        self.skip_to_number()?;
        let value = self.cursor.integer("an integer")?;
        match self.cursor.peek() {
            None | Some(b' ' | b'\t' | b'\n' | b'\r') => Ok(value),
            Some(_) => Err(self.cursor.expected("a blank after an integer")),
        }
    }

    fn skip_numbers(&mut self, _: ScalarType, count: usize) -> Result<(), MeshError> {
        for _ in 0..count {
            self.skip_to_number()?;
            self.cursor.word();
        }
        Ok(())
    }

    fn min_size(_: ScalarType) -> usize {
        1
    }

    fn bytes_left(&self) -> usize {
        self.cursor.rest().len()
    }

    fn take_rows(&mut self, _: &Element) -> Option<(&[u8], ByteOrder)> {
        None
    }

    fn error(&self, kind: MeshErrorKind, message: String) -> MeshError {
        self.cursor.error(kind, message)
    }
}
