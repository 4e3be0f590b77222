//! A cursor over the bytes of a text format that knows its line.

use crate::error::{MeshError, MeshErrorKind};
use crate::number::{parse_any_float, parse_integer, parse_plain_float, parse_short_integer};
use memchr::memchr2;

/// A place in a text. Lines end in LF, CRLF or CR; a backslash before the end of a line joins it
/// with the next one; `#` starts a comment.
pub(crate) struct TextCursor<'a> {
    bytes: &'a [u8],
    position: usize,
    line: u64,
}

impl<'a> TextCursor<'a> {
    /// The start of `bytes`, after a byte order mark if there is one.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        Self { bytes, position: 0, line: 1 }
    }

    /// The line of the cursor, counted from one.
    pub(crate) fn line(&self) -> u64 {
        self.line
    }

    /// Whether everything was read.
    #[inline]
    pub(crate) fn is_at_end(&self) -> bool {
        self.position >= self.bytes.len()
    }

    /// All bytes from the cursor on, not taken.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.position..).unwrap_or_default()
    }

    /// The next byte, not taken.
    #[inline]
    pub(crate) fn peek(&self) -> Option<u8> {
        self.bytes.get(self.position).copied()
    }

    /// Moves on over `count` bytes that were peeked at.
    #[inline]
    pub(crate) fn advance(&mut self, count: usize) {
        self.position += count;
    }

    /// Moves over blanks and joined line ends.
    #[inline]
    pub(crate) fn skip_blanks(&mut self) {
        loop {
            match self.peek() {
                Some(b' ' | b'\t') => self.position += 1,
                Some(b'\\') if self.skip_joined_line_end() => {}
                _ => return,
            }
        }
    }

    /// Whether a backslash and a line end were here; the cursor is then on the next line.
    fn skip_joined_line_end(&mut self) -> bool {
        let length = match self.bytes.get(self.position + 1..) {
            Some([b'\r', b'\n', ..]) => 3,
            Some([b'\n' | b'\r', ..]) => 2,
            _ => return false,
        };
        self.position += length;
        self.line += 1;
        true
    }

    /// Whether the statement ends here: at a line end, a comment, or the end of the input.
    #[inline]
    pub(crate) fn is_at_statement_end(&self) -> bool {
        matches!(self.peek(), None | Some(b'\n' | b'\r' | b'#'))
    }

    /// The word at the cursor, up to a blank or line end.
    #[inline]
    pub(crate) fn word(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.position..];
        let is_end = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\n' | b'\r');
        let length = rest.iter().position(is_end).unwrap_or(rest.len());
        self.position += length;
        &rest[..length]
    }

    /// The rest of this line without its end, taken.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.position..];
        let length = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        self.position += length;
        &rest[..length]
    }

    /// Moves over the end of this line. Does nothing where the cursor is not at one.
    #[inline]
    pub(crate) fn take_line_end(&mut self) {
        match self.peek() {
            Some(b'\n') => self.position += 1,
            Some(b'\r') if self.bytes.get(self.position + 1) == Some(&b'\n') => self.position += 2,
            Some(b'\r') => self.position += 1,
            _ => return,
        }
        self.line += 1;
    }

    /// Moves to the end of the line on which this statement ends.
    pub(crate) fn skip_statement(&mut self) {
        loop {
            let is_comment = self.peek() == Some(b'#');
            let skipped = self.rest_of_line();
            let is_joined = !is_comment && skipped.last() == Some(&b'\\') && !self.is_at_end();
            if !is_joined {
                return;
            }
            self.take_line_end();
        }
    }

    /// A number, taken with the blanks after it. It may be infinite or NaN.
    ///
    /// # Errors
    ///
    /// A [`MeshErrorKind::Syntax`] error that calls the number `what`.
    #[inline(always)]
    pub(crate) fn float(&mut self, what: &str) -> Result<f32, MeshError> {
        match self.take_float(parse_plain_float(self.rest())) {
            Some(value) => Ok(value),
            None => self.any_float(what),
        }
    }

    /// [`TextCursor::float`] for all notations.
    #[inline(never)]
    fn any_float(&mut self, what: &str) -> Result<f32, MeshError> {
        self.take_float(parse_any_float(self.rest())).ok_or_else(|| self.expected(what))
    }

    /// Takes a number that was found at the cursor, and the blanks after it, if it ends where one may.
    #[inline(always)]
    fn take_float(&mut self, found: Option<(f32, usize)>) -> Option<f32> {
        let (value, length) = found?;
        if !self.is_delimiter(self.position + length) {
            return None;
        }
        self.position += length;
        self.skip_blanks();
        Some(value)
    }

    /// An integer of one to seven digits without a sign, not taken, and how many digits; `None` where
    /// there is another or none.
    #[inline(always)]
    pub(crate) fn peek_short_integer(&self) -> Option<(u32, usize)> {
        parse_short_integer(self.rest())
    }

    /// Whether the number of `length` digits (one to seven) at the cursor comes three times, with a
    /// slash between each two, and nothing more: how writers with one list of vertices name the
    /// corners of faces.
    #[inline(always)]
    pub(crate) fn is_threefold(&self, length: usize) -> bool {
        let after = length + 1;
        let characters = |place: usize| {
            let chunk = self.bytes.get(self.position + place..)?.first_chunk()?;
            Some(u64::from_le_bytes(*chunk))
        };
        let (Some(first), Some(second), Some(third)) =
            (characters(0), characters(after), characters(2 * after))
        else {
            return false;
        };
        // What differs from the digits with a slash behind them.
        let digits = !(u64::MAX << (8 * length));
        let slash = u64::from(b'/') << (8 * length);
        let digits_and_slash = digits | u64::from(u8::MAX) << (8 * length);
        let expected = first & digits | slash;
        let differs = ((first ^ expected) | (second ^ expected)) & digits_and_slash
            | (third ^ expected) & digits;
        differs == 0 && self.is_delimiter(self.position + Self::threefold(length))
    }

    /// How many bytes a number of `length` digits takes three times.
    #[inline(always)]
    pub(crate) fn threefold(length: usize) -> usize {
        3 * length + 2
    }

    /// An integer, taken alone.
    ///
    /// # Errors
    ///
    /// A [`MeshErrorKind::Syntax`] error that calls the number `what`.
    pub(crate) fn integer(&mut self, what: &str) -> Result<i64, MeshError> {
        match parse_integer(&self.bytes[self.position..]) {
            Some((value, length)) => {
                self.position += length;
                Ok(value)
            }
            None => Err(self.expected(what)),
        }
    }

    /// Whether a number may end before this byte.
    #[inline]
    fn is_delimiter(&self, position: usize) -> bool {
        let byte = self.bytes.get(position);
        matches!(byte, None | Some(b' ' | b'\t' | b'\n' | b'\r' | b'\\' | b'#'))
    }

    /// An error that says what should stand here and what does.
    #[cold]
    pub(crate) fn expected(&self, what: &str) -> MeshError {
        const SHOWN: usize = 24;
        let rest = &self.bytes[self.position.min(self.bytes.len())..];
        let length = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len()).min(SHOWN);
        let found = match length {
            0 => "the end of the line".to_owned(),
            _ => format!("`{}`", String::from_utf8_lossy(&rest[..length]).escape_debug()),
        };
        self.error(MeshErrorKind::Syntax, format!("expected {what}, found {found}"))
    }

    /// An error at the line of the cursor.
    #[cold]
    pub(crate) fn error(&self, kind: MeshErrorKind, message: impl Into<String>) -> MeshError {
        MeshError::new(kind, message).at_line(self.line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_over_every_kind_of_end() {
        let mut cursor = TextCursor::new(b"a\nb\r\nc\rd \\\n e\nf");
        let mut words = Vec::new();
        while !cursor.is_at_end() {
            cursor.skip_blanks();
            let line = cursor.line();
            words.push((String::from_utf8_lossy(cursor.word()).into_owned(), line));
            cursor.take_line_end();
        }
        let expected = [("a", 1), ("b", 2), ("c", 3), ("d", 4), ("e", 5), ("f", 6)];
        assert_eq!(words, expected.map(|(word, line)| (word.to_owned(), line)));
    }

    #[test]
    fn a_statement_is_skipped_with_its_joined_lines_but_a_comment_is_not_joined() {
        let mut cursor = TextCursor::new(b"l 1 2 \\\r\n 3 4\nv # x \\\ny");
        cursor.skip_statement();
        cursor.take_line_end();
        assert_eq!((cursor.line(), cursor.peek()), (3, Some(b'v')));
        cursor.advance(2);
        cursor.skip_statement();
        cursor.take_line_end();
        assert_eq!((cursor.line(), cursor.peek()), (4, Some(b'y')));
    }

    #[test]
    fn numbers_end_at_blanks_only() {
        assert_eq!(TextCursor::new(b"1.5 2").float("x"), Ok(1.5));
        let error = TextCursor::new(b"1.2.3").float("a coordinate").unwrap_err();
        assert_eq!(error.kind, MeshErrorKind::Syntax);
        assert_eq!(error.to_string(), "line 1: expected a coordinate, found `1.2.3`");
        let error = TextCursor::new(b"\n").integer("an index").unwrap_err();
        assert_eq!(error.to_string(), "line 1: expected an index, found the end of the line");
    }
}
