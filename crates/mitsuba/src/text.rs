//! Converts bytes to text, with clear errors for files that are not XML.

/// Why bytes are not text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NotText {
    /// One sentence without a full stop.
    pub(crate) message: String,
    /// The offset of the first invalid byte, in `shown`.
    pub(crate) offset: usize,
    /// The part of the text that can be shown.
    pub(crate) shown: String,
}

/// The text of a file, without a byte order mark.
pub(crate) fn decode(mut bytes: Vec<u8>) -> Result<String, NotText> {
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes.drain(..3);
    }
    let fail = |message: &str| {
        Err(NotText { message: message.to_owned(), offset: 0, shown: String::new() })
    };
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return fail("the file is empty");
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return fail("the file is UTF-16; save it as UTF-8");
    }
    if bytes.contains(&0) {
        return fail("this is a binary file, not XML");
    }
    String::from_utf8(bytes).map_err(|error| {
        let utf8_error = error.utf8_error();
        invalid_utf8(error.as_bytes(), &utf8_error)
    })
}

/// Reports the first byte that is not UTF-8, shown after the text before it.
fn invalid_utf8(bytes: &[u8], error: &std::str::Utf8Error) -> NotText {
    let offset = error.valid_up_to();
    let line_end = bytes[offset..].iter().position(|byte| *byte == b'\n');
    let end = line_end.map_or(bytes.len(), |length| offset + length);
    let message = format!("byte 0x{:02x} is not UTF-8; save the file as UTF-8", bytes[offset]);
    NotText { message, offset, shown: String::from_utf8_lossy(&bytes[..end]).into_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_passes_with_and_without_a_mark() {
        assert_eq!(decode(b"<scene/>".to_vec()).unwrap(), "<scene/>");
        assert_eq!(decode(b"\xef\xbb\xbf<scene/>".to_vec()).unwrap(), "<scene/>");
    }

    #[test]
    fn what_is_no_text_is_named() {
        let message = |bytes: &[u8]| decode(bytes.to_vec()).unwrap_err().message;
        assert_eq!(message(b""), "the file is empty");
        assert_eq!(message(b" \n\t"), "the file is empty");
        assert!(message(b"\xff\xfe<\0").contains("UTF-16"));
        assert!(message(b"<sc\0").contains("binary"));
        let invalid = decode(b"<scene>\n <!-- caf\xe9 -->\n</scene>".to_vec()).unwrap_err();
        assert_eq!(invalid.offset, 17);
        assert!(invalid.message.contains("0xe9"));
        assert!(invalid.shown.starts_with("<scene>\n <!-- caf"));
    }
}
