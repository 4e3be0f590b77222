//! Large texts, compressed until they are needed.

use std::io::Read;

use flate2::Compression;
use flate2::read::{DeflateDecoder, DeflateEncoder};

/// A text in compressed chunks.
#[derive(Clone, Debug)]
pub(crate) struct Packed {
    pieces: Vec<Box<[u8]>>,
    length: usize,
}

/// The bytes of text per chunk.
const PIECE: usize = 1 << 20;

impl Packed {
    /// Compresses a text; `None` on failure.
    pub(crate) fn new(text: &str) -> Option<Self> {
        let pack = |piece: &[u8]| {
            let mut packed = Vec::new();
            DeflateEncoder::new(piece, Compression::fast()).read_to_end(&mut packed).ok()?;
            Some(packed.into_boxed_slice())
        };
        let pieces = text.as_bytes().chunks(PIECE).map(pack).collect::<Option<_>>()?;
        Some(Self { pieces, length: text.len() })
    }

    /// The bytes of the text, chunk by chunk; a chunk may end within a character.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = Vec<u8>> {
        self.pieces.iter().map(|piece| {
            let mut bytes = Vec::with_capacity(PIECE);
            // This type packed the data itself, so unpacking cannot fail; an error would show in
            // the length.
            let _ = DeflateDecoder::new(&**piece).read_to_end(&mut bytes);
            bytes
        })
    }

    /// The text.
    pub(crate) fn unpack(&self) -> String {
        let mut bytes = Vec::with_capacity(self.length);
        self.pieces().for_each(|piece| bytes.extend_from_slice(&piece));
        String::from_utf8(bytes).unwrap_or_default()
    }

    /// The length of the text in bytes.
    pub(crate) fn length(&self) -> usize {
        self.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_comes_back_whole_and_takes_less_meanwhile() {
        for count in [0, 1, 200_000] {
            let text = "<shape type=\"größe\"/>\n".repeat(count);
            let packed = Packed::new(&text).unwrap();
            assert_eq!((packed.unpack(), packed.length()), (text.clone(), text.len()));
            let bytes: usize = packed.pieces.iter().map(|piece| piece.len()).sum();
            assert!(bytes <= 100 + text.len() / 20, "{bytes} of {}", text.len());
        }
    }
}
