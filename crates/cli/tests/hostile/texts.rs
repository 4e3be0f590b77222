//! Malformed scene files.

use crate::case::Case;

/// A whole file, the line of the first error, and text that it must contain.
fn case(scene: impl Into<Vec<u8>>, line: Option<usize>, message: &str) -> Case {
    let scene = scene.into();
    let start = &scene[..scene.len().min(80)];
    let name = String::from_utf8_lossy(start).into_owned();
    Case { name, scene, line, ..Case::content("", message) }
}

fn utf_16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(bytes).collect()
}

#[test]
fn malformed_files_are_rejected() {
    let cases = [
        case("<", Some(1), "name"),
        case("<scene", Some(1), "no element"),
        case("<?xml version=\"1.0\"?>\n", Some(2), "no element"),
        case("{\"scene\": 1}", None, "a JSON file"),
        case("<scene>\n<!-- -->\n<!-- </scene>", Some(3), "-->"),
        case("<scene>\n<![CDATA[ </scene>", Some(2), "]]>"),
        case("<scene>\n<shape type=\"a\n</scene>", Some(2), "quote"),
        case("<scene a=1/>", Some(1), "quote"),
        case("<scene>\n&amp\n</scene>", Some(2), "&amp;"),
        case("<scene>\n<shape type=\"&#0;\"/></scene>", Some(2), "entity"),
        case("<scene>\n\u{1}</scene>", Some(2), "character"),
        case("<!DOCTYPE scene SYSTEM \"file:///etc/passwd\"><scene/>", Some(1), "DOCTYPE"),
        case("<bsdf type=\"diffuse\"/>", Some(1), "`<bsdf>`"),
        case("<b:scene/>", Some(1), "prefix"),
        case("<scene version=\"3.0.0\"/>", None, "no sensor"),
        case(b"\x7fELF\0\0\0\0".as_slice(), Some(1), "binary"),
        case(b"\xff\xfe\0\0<\0\0\0".as_slice(), Some(1), "binary"),
        case(utf_16("\u{feff}<scene/>", u16::to_le_bytes), None, "no sensor"),
        case(utf_16("\u{feff}<scene/>", u16::to_be_bytes), None, "no sensor"),
        case(utf_16("<scene/>", u16::to_le_bytes), None, "no sensor"),
        case(b"<scene>\n<a b=\"\xe9\"/></scene>".as_slice(), Some(2), "no element `<a>`"),
    ];
    cases.iter().for_each(Case::check);
}
