//! Converts bytes to text, with clear errors for files that are not XML.
//!
//! Scenes are UTF-8. Files in the other encodings that editors on Windows write are read too, with
//! a warning.

use std::ops::Range;

/// The text of a file, without a byte order mark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Decoded {
    pub(crate) text: String,
    /// What to say about the encoding, and where in the text, unless it is UTF-8.
    pub(crate) warning: Option<(String, Range<usize>)>,
}

/// Why bytes are not text: one sentence without a full stop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NotText(pub(crate) &'static str);

/// The characters of the bytes 0x80 to 0x9f in windows-1252. The five unassigned bytes keep their
/// numbers, as in the Encoding Standard (WHATWG, section 9.1).
const WINDOWS_1252: [char; 32] = [
    '\u{20ac}', '\u{81}', '\u{201a}', '\u{192}', '\u{201e}', '\u{2026}', '\u{2020}', '\u{2021}',
    '\u{2c6}', '\u{2030}', '\u{160}', '\u{2039}', '\u{152}', '\u{8d}', '\u{17d}', '\u{8f}',
    '\u{90}', '\u{2018}', '\u{2019}', '\u{201c}', '\u{201d}', '\u{2022}', '\u{2013}', '\u{2014}',
    '\u{2dc}', '\u{2122}', '\u{161}', '\u{203a}', '\u{153}', '\u{9d}', '\u{17e}', '\u{178}',
];

/// The declared names of ISO-8859-1 and windows-1252, which extends it. Both are read as the
/// latter, because files that declare the former often hold its quotes and dashes.
const WESTERN: [&str; 8] = [
    "iso-8859-1",
    "iso8859-1",
    "iso_8859-1",
    "latin1",
    "latin-1",
    "windows-1252",
    "cp1252",
    "cp-1252",
];

/// Decodes a file in UTF-8, UTF-16 of either byte order, ISO-8859-1 or windows-1252.
pub(crate) fn decode(mut bytes: Vec<u8>) -> Result<Decoded, NotText> {
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes.drain(..3);
    }
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(NotText("the file is empty"));
    }
    let of_units: Option<fn([u8; 2]) -> u16> = match bytes[..] {
        [0xff, 0xfe, ..] | [b'<', 0, ..] => Some(u16::from_le_bytes),
        [0xfe, 0xff, ..] | [0, b'<', ..] => Some(u16::from_be_bytes),
        _ => None,
    };
    if let Some(unit) = of_units {
        let units = bytes.as_chunks::<2>().0.iter().map(|pair| unit(*pair));
        let characters = char::decode_utf16(units).map(|found| found.unwrap_or('\u{fffd}'));
        let text: String = characters.skip_while(|first| *first == '\u{feff}').collect();
        if text.contains('\0') {
            return Err(NotText("this is a binary file, not XML"));
        }
        return Ok(warned(text, 0, "UTF-16"));
    }
    if bytes.contains(&0) {
        return Err(NotText("this is a binary file, not XML"));
    }
    let declared = declared_encoding(&bytes).is_some_and(|name| WESTERN.contains(&name.as_str()));
    if let Some(first) = bytes.iter().position(|byte| !byte.is_ascii()).filter(|_| declared) {
        return Ok(warned(from_windows_1252(&bytes), first, "ISO-8859-1 or windows-1252"));
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok(Decoded { text, warning: None }),
        Err(error) => {
            let (valid, rest) = error.as_bytes().split_at(error.utf8_error().valid_up_to());
            let mut text = from_windows_1252(valid);
            let first = text.len();
            text.push_str(&from_windows_1252(rest));
            Ok(warned(text, first, "not UTF-8, but probably windows-1252"))
        }
    }
}

/// A text in another encoding than UTF-8, which first matters at the offset `place`.
fn warned(text: String, place: usize, encoding: &str) -> Decoded {
    let length = text[place..].chars().next().map_or(0, char::len_utf8);
    let message = format!("the file is {encoding}; save it as UTF-8 to be sure of its names");
    Decoded { text, warning: Some((message, place..place + length)) }
}

fn from_windows_1252(bytes: &[u8]) -> String {
    let character = |byte: &u8| match byte {
        0x80..=0x9f => WINDOWS_1252[usize::from(byte - 0x80)],
        _ => char::from(*byte),
    };
    bytes.iter().map(character).collect()
}

/// The encoding in the XML declaration, in lower case.
fn declared_encoding(bytes: &[u8]) -> Option<String> {
    let start = bytes.trim_ascii_start().strip_prefix(b"<?xml")?;
    let end = start.windows(2).position(|pair| pair == b"?>")?;
    let declaration = std::str::from_utf8(&start[..end]).ok()?;
    let (_, value) = declaration.split_once("encoding")?;
    let quoted = value.trim_start().strip_prefix('=')?.trim_start();
    let name = quoted.split(['"', '\'']).nth(1)?;
    Some(name.to_ascii_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf16(text: &str, bytes_of: fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(bytes_of).collect()
    }

    #[test]
    fn utf8_passes_with_and_without_a_mark() {
        for bytes in [&b"<scene/>"[..], b"\xef\xbb\xbf<scene/>"] {
            let decoded = decode(bytes.to_vec()).unwrap();
            assert_eq!((decoded.text.as_str(), decoded.warning), ("<scene/>", None));
        }
        let declared = "<?xml version='1.0' encoding='utf-8'?><!-- Größe --><scene/>";
        assert_eq!(decode(declared.as_bytes().to_vec()).unwrap().text, declared);
    }

    #[test]
    fn both_orders_of_utf16_are_read_with_and_without_a_mark() {
        let text = "<?xml version=\"1.0\" encoding=\"utf-16\"?>\n<scene id=\"Größe 🌞\"/>";
        for bytes_of in [u16::to_le_bytes, u16::to_be_bytes] {
            for mark in ["", "\u{feff}"] {
                let decoded = decode(utf16(&format!("{mark}{text}"), bytes_of)).unwrap();
                assert_eq!(decoded.text, text);
                let (message, place) = decoded.warning.unwrap();
                assert!(message.contains("UTF-16") && place == (0..1), "{message}");
            }
        }
        let broken = decode(b"<\0a\0\x00\xd8>\0x".to_vec()).unwrap();
        assert_eq!(broken.text, "<a\u{fffd}>", "a lone surrogate and a last odd byte");
    }

    #[test]
    fn western_encodings_are_read_declared_or_not() {
        let head = b"<?xml version='1.0' encoding='ISO-8859-1'?>";
        let body = b"<scene>\n <!-- caf\xe9 \x93quoted\x94 -->\n</scene>";
        let expected = "<scene>\n <!-- café “quoted” -->\n</scene>";
        let declared = decode([&head[..], body].concat()).unwrap();
        assert!(declared.text.ends_with(expected));
        assert!(declared.warning.unwrap().0.contains("ISO-8859-1"));
        let undeclared = decode(body.to_vec()).unwrap();
        assert_eq!(undeclared.text, expected);
        let (message, place) = undeclared.warning.unwrap();
        assert!(message.contains("windows-1252"), "{message}");
        assert_eq!(&undeclared.text[place], "é");
        let ascii = decode([&head[..], b"<scene/>"].concat()).unwrap();
        assert_eq!(ascii.warning, None, "the declaration makes no difference");
    }

    #[test]
    fn what_is_no_text_is_named() {
        let message = |bytes: &[u8]| decode(bytes.to_vec()).unwrap_err().0;
        assert_eq!(message(b""), "the file is empty");
        assert_eq!(message(b" \n\t"), "the file is empty");
        assert!(message(b"<sc\0").contains("binary"));
        assert!(message(b"<\0\0\0s\0\0\0").contains("binary"), "UTF-32");
    }
}
