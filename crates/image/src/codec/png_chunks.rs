//! The chunks of PNG files: what they say about colours, and texts.

use flate2::Crc;

use crate::{MetadataValue, Picture};

/// The length of the signature before the first chunk.
const SIGNATURE: usize = 8;

/// The keyword of programs, and their name in metadata.
const SOFTWARE: (&str, &str) = ("Software", "software");

/// The longest keyword of a text in bytes.
const MAX_KEYWORD: usize = 79;

/// The chunks of a file: their types, the lengths that they claim, and their data, which may end
/// early.
pub(super) fn chunks(bytes: &[u8]) -> impl Iterator<Item = ([u8; 4], usize, &[u8])> {
    let mut rest = bytes.get(SIGNATURE..).unwrap_or(&[]);
    std::iter::from_fn(move || {
        // A chunk consists of the length of its data, its type, the data, and a checksum.
        let (&[a, b, c, d, ref kind @ ..], after) = rest.split_first_chunk::<8>()?;
        let length = u32::from_be_bytes([a, b, c, d]) as usize;
        rest = after.get(length.saturating_add(4)..).unwrap_or(&[]);
        Some((*kind, length, &after[..length.min(after.len())]))
    })
}

/// Adds to an encoded picture that it is sRGB encoded, and the texts and integers of the metadata.
/// Times are left out, so that two renders of a scene give the same file.
pub(super) fn annotate(png: Vec<u8>, picture: &Picture) -> Vec<u8> {
    let Some((_, length, _)) = chunks(&png).next() else {
        return png;
    };
    // The header, which must come first.
    let (start, rest) = png.split_at(SIGNATURE + 12 + length);
    let mut annotated = start.to_vec();
    // The rendering intent 0 is perceptual.
    push(&mut annotated, b"sRGB", &[0]);
    for (name, value) in &picture.metadata {
        let text = match value {
            MetadataValue::Text(text) => text.clone(),
            MetadataValue::Integer(number) => number.to_string(),
            _ => continue,
        };
        // The keyword that the specification has for programs.
        let keyword = if name == SOFTWARE.1 { SOFTWARE.0 } else { name };
        push_text(&mut annotated, keyword, &text);
    }
    annotated.extend_from_slice(rest);
    annotated
}

/// The texts of a file, by name. Compressed texts are left out.
pub(super) fn texts(png: &[u8]) -> Vec<(String, String)> {
    chunks(png)
        .filter_map(|(kind, _, data)| {
            let end = data.iter().position(|byte| *byte == 0)?;
            let (keyword, rest) = (&data[..end], &data[end + 1..]);
            let latin1 = |bytes: &[u8]| bytes.iter().map(|byte| char::from(*byte)).collect();
            let text = match &kind {
                b"tEXt" => latin1(rest),
                // Flag and method of the compression, then language and translated keyword.
                b"iTXt" if rest.first() == Some(&0) => {
                    let text = rest.get(2..)?.splitn(3, |byte| *byte == 0).nth(2)?;
                    String::from_utf8(text.to_vec()).ok()?
                }
                _ => return None,
            };
            let keyword: String = latin1(keyword);
            let name = if keyword == SOFTWARE.0 { SOFTWARE.1.to_owned() } else { keyword };
            Some((name, text))
        })
        .collect()
}

/// Appends a text, unless its keyword does not fit the format.
fn push_text(png: &mut Vec<u8>, keyword: &str, text: &str) {
    let fits = |c: char| matches!(c, ' '..='~');
    if keyword.is_empty() || keyword.len() > MAX_KEYWORD || !keyword.chars().all(fits) {
        return;
    }
    let text = text.replace('\0', " ");
    let mut data = keyword.as_bytes().to_vec();
    if text.chars().all(fits) {
        data.push(0);
        data.extend_from_slice(text.as_bytes());
        push(png, b"tEXt", &data);
    } else {
        data.extend_from_slice(&[0; 5]);
        data.extend_from_slice(text.as_bytes());
        push(png, b"iTXt", &data);
    }
}

fn push(png: &mut Vec<u8>, kind: &[u8; 4], data: &[u8]) {
    let mut checksum = Crc::new();
    checksum.update(kind);
    checksum.update(data);
    // Metadata is far shorter than 4 GiB.
    png.extend_from_slice(&(data.len() as u32).to_be_bytes());
    png.extend_from_slice(kind);
    png.extend_from_slice(data);
    png.extend_from_slice(&checksum.sum().to_be_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EncodeOptions, FileFormat, decode, encode};

    #[test]
    fn texts_and_the_colour_space_are_written_and_the_picture_still_reads() {
        let mut picture = Picture::new(2, 1);
        picture.push("Y", vec![0.5, 1.0]);
        picture.metadata = vec![
            ("software".into(), MetadataValue::Text("Etendue".into())),
            ("samplesPerPixel".into(), MetadataValue::Integer(64)),
            ("scene".into(), MetadataValue::Text("杯子/scene.xml".into())),
            ("renderSeconds".into(), MetadataValue::Float(1.5)),
            ("k".repeat(80), MetadataValue::Integer(1)),
        ];
        let png = encode(&picture, FileFormat::Png, &EncodeOptions::default()).unwrap();
        let expected =
            [("software", "Etendue"), ("samplesPerPixel", "64"), ("scene", "杯子/scene.xml")];
        let expected = expected.map(|(a, b)| (a.to_owned(), b.to_owned()));
        assert_eq!(texts(&png), expected);
        let kinds: Vec<[u8; 4]> = chunks(&png).map(|(kind, ..)| kind).collect();
        assert_eq!(&kinds[..2], [*b"IHDR", *b"sRGB"]);
        let again = encode(
            &crate::decode_picture(&png, "").unwrap(),
            FileFormat::Png,
            &EncodeOptions::default(),
        );
        assert_eq!(texts(&again.unwrap()), expected);
        // The decoder checks the checksums.
        let read = decode(&png, "").unwrap();
        assert!(read.warnings.is_empty() && read.srgb);
    }

    #[test]
    fn chunks_that_end_early_are_cut() {
        let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
        png.extend_from_slice(&[0xff, 0xff, 0xff, 0xff, b't', b'E', b'X', b't', b'a', 0, b'b']);
        assert_eq!(texts(&png), [("a".to_owned(), "b".to_owned())]);
        assert!(texts(b"\x89PNG\r\n\x1a\n\0\0").is_empty());
    }
}
