//! A cursor over a text format that tracks the line number.

use crate::error::{MeshError, MeshErrorKind};
use crate::number::{
    is_windows_non_finite, parse_any_float, parse_integer, parse_plain_float, parse_short_integer,
    parse_windows_non_finite,
};
use memchr::{memchr2, memrchr2};

/// A position in a text. Lines end in LF, CRLF or CR; a backslash at the end of a line continues it
/// on the next one; `#` starts a comment.
pub(crate) struct TextCursor<'a> {
    bytes: &'a [u8],
    position: usize,
    line: u64,
}

impl<'a> TextCursor<'a> {
    /// The start of `bytes`, after a byte order mark, if any.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        Self { bytes, position: 0, line: 1 }
    }

    /// The line of the cursor, starting at one.
    pub(crate) fn line(&self) -> u64 {
        self.line
    }

    #[inline]
    pub(crate) fn is_at_end(&self) -> bool {
        self.position >= self.bytes.len()
    }

    /// All bytes from the cursor on, without consuming them.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.position..).unwrap_or_default()
    }

    /// The next byte, without consuming it.
    #[inline]
    pub(crate) fn peek(&self) -> Option<u8> {
        self.bytes.get(self.position).copied()
    }

    /// Consumes `count` bytes that have been peeked at.
    #[inline]
    pub(crate) fn advance(&mut self, count: usize) {
        self.position += count;
    }

    /// Skips blanks and line continuations.
    #[inline]
    pub(crate) fn skip_blanks(&mut self) {
        loop {
            match self.peek() {
                Some(b' ' | b'\t') => self.position += 1,
                Some(b'\\') if self.skip_continuation() => {}
                _ => return,
            }
        }
    }

    /// Skips a backslash with a line end, if the cursor is at one.
    fn skip_continuation(&mut self) -> bool {
        let length = match self.bytes.get(self.position + 1..) {
            Some([b'\r', b'\n', ..]) => 3,
            Some([b'\n' | b'\r', ..]) => 2,
            _ => return false,
        };
        self.position += length;
        self.line += 1;
        true
    }

    /// Whether the cursor is at the end of a statement: a line end, a comment, or the end of the
    /// input.
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

    /// Consumes the rest of this line without its end.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.position..];
        let length = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        self.position += length;
        &rest[..length]
    }

    /// Consumes a line end, if the cursor is at one.
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

    /// Moves to the end of the line where this statement ends.
    pub(crate) fn skip_statement(&mut self) {
        loop {
            let is_comment = self.peek() == Some(b'#');
            let skipped = self.rest_of_line();
            let is_continued = !is_comment && skipped.last() == Some(&b'\\') && !self.is_at_end();
            if !is_continued {
                return;
            }
            self.take_line_end();
        }
    }

    /// Consumes a number and the blanks after it. It may be infinite or NaN.
    ///
    /// # Errors
    ///
    /// A [`MeshErrorKind::Syntax`] error that describes the number as `what`.
    #[inline(always)]
    pub(crate) fn float(&mut self, what: &str) -> Result<f32, MeshError> {
        match self.take_float(parse_plain_float(self.rest())) {
            Some(value) => Ok(value),
            None => self.any_float(what),
        }
    }

    /// [`TextCursor::float`] for every notation.
    #[inline(never)]
    fn any_float(&mut self, what: &str) -> Result<f32, MeshError> {
        self.take_float(parse_any_float(self.rest()))
            .or_else(|| self.take_float(parse_windows_non_finite(self.rest())))
            .ok_or_else(|| self.expected(what))
    }

    /// Consumes a number found at the cursor and the blanks after it, if a delimiter follows.
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

    /// An integer of one to seven digits without a sign, and the number of digits, without
    /// consuming it. `None` for anything else.
    #[inline(always)]
    pub(crate) fn peek_short_integer(&self) -> Option<(u32, usize)> {
        parse_short_integer(self.rest())
    }

    /// Whether the cursor is at a triple like `12/12/12`, where `length` (one to seven) is the
    /// length of the number. Exporters with a single index per vertex write the corners of faces
    /// like this.
    #[inline(always)]
    pub(crate) fn is_index_triple(&self, length: usize) -> bool {
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
        // The bits that differ from the digits followed by a slash.
        let digits = !(u64::MAX << (8 * length));
        let slash = u64::from(b'/') << (8 * length);
        let digits_and_slash = digits | u64::from(u8::MAX) << (8 * length);
        let expected = first & digits | slash;
        let differs = ((first ^ expected) | (second ^ expected)) & digits_and_slash
            | (third ^ expected) & digits;
        differs == 0 && self.is_delimiter(self.position + Self::triple_length(length))
    }

    /// The length of a triple of numbers with `length` digits.
    #[inline(always)]
    pub(crate) fn triple_length(length: usize) -> usize {
        3 * length + 2
    }

    /// Consumes an integer, without the blanks after it.
    ///
    /// # Errors
    ///
    /// A [`MeshErrorKind::Syntax`] error that describes the number as `what`.
    pub(crate) fn integer(&mut self, what: &str) -> Result<i64, MeshError> {
        match parse_integer(&self.bytes[self.position..]) {
            Some((value, length)) => {
                self.position += length;
                Ok(value)
            }
            None => Err(self.expected(what)),
        }
    }

    /// Whether the byte at this position may follow a number.
    #[inline]
    fn is_delimiter(&self, position: usize) -> bool {
        match self.bytes.get(position) {
            None | Some(b' ' | b'\t' | b'\n' | b'\r' | b'\\') => true,
            Some(b'#') => !is_windows_non_finite(&self.bytes[position..]),
            _ => false,
        }
    }

    /// An error that says what was expected, and in which column. It does not quote the text, because
    /// a scene may name any file of the machine.
    #[cold]
    pub(crate) fn expected(&self, what: &str) -> MeshError {
        let before = &self.bytes[..self.position.min(self.bytes.len())];
        let column = 1 + memrchr2(b'\n', b'\r', before)
            .map_or(before.len(), |line_end| before.len() - line_end - 1);
        self.error(MeshErrorKind::Syntax, format!("expected {what} in column {column}"))
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
    fn all_kinds_of_line_ends_are_counted() {
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
    fn skipping_a_statement_follows_continuations_but_not_in_comments() {
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
    fn numbers_must_end_at_a_delimiter() {
        assert_eq!(TextCursor::new(b"1.5 2").float("x"), Ok(1.5));
        let error = TextCursor::new(b"1.2.3").float("a coordinate").unwrap_err();
        assert_eq!(error.kind, MeshErrorKind::Syntax);
        assert_eq!(error.to_string(), "line 1: expected a coordinate in column 1");
        let error = TextCursor::new(b"\n").integer("an index").unwrap_err();
        assert_eq!(error.to_string(), "line 1: expected an index in column 1");
    }
}
