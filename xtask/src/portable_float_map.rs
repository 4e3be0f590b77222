//! Portable float maps: the format in which pictures pass between `etendue convert` and these
//! commands, because a few lines read and write it.

use std::path::Path;

/// A picture of colours, the top row first.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Picture {
    /// Width and height in pixels.
    pub(crate) size: [usize; 2],
    /// Three numbers a pixel; grey is repeated.
    pub(crate) pixels: Vec<[f32; 3]>,
}

/// Reads a map as `etendue convert` writes it: little endian, from the bottom row up.
///
/// # Errors
/// What the file system or the format complains of.
pub(crate) fn read(path: &Path) -> Result<Picture, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    decode(&bytes).ok_or_else(|| format!("{}: not a portable float map", path.display()))
}

/// Writes a map.
///
/// # Errors
/// What the file system complains of.
pub(crate) fn write(path: &Path, picture: &Picture) -> Result<(), String> {
    std::fs::write(path, encode(picture)).map_err(|error| format!("{}: {error}", path.display()))
}

fn decode(bytes: &[u8]) -> Option<Picture> {
    let mut lines = bytes.splitn(4, |byte| *byte == b'\n');
    let mut text = || std::str::from_utf8(lines.next()?).ok();
    let channels = match text()? {
        "PF" => 3,
        "Pf" => 1,
        _ => return None,
    };
    let (width, height) = text()?.split_once(' ')?;
    let size: [usize; 2] = [width.parse().ok()?, height.parse().ok()?];
    if text()? != "-1.0" {
        return None;
    }
    let samples = lines.next()?.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
    let samples: Vec<f32> = samples.collect();
    let row_length = size[0].checked_mul(channels)?;
    if row_length == 0 || samples.len() != row_length.checked_mul(size[1])? {
        return None;
    }
    let rows = samples.chunks_exact(row_length).rev();
    let pixel = |values: &[f32]| [values[0], values[values.len() / 2], values[values.len() - 1]];
    Some(Picture { size, pixels: rows.flat_map(|row| row.chunks(channels).map(pixel)).collect() })
}

fn encode(picture: &Picture) -> Vec<u8> {
    let [width, height] = picture.size;
    let mut bytes = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
    for row in picture.pixels.chunks(width.max(1)).rev() {
        bytes.extend(row.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let pixels = (0..6_u8).map(|index| [index, index + 10, index + 20].map(f32::from));
        let picture = Picture { size: [2, 3], pixels: pixels.collect() };
        let bytes = encode(&picture);
        assert_eq!(bytes[12..16], 4.0_f32.to_le_bytes(), "the last row comes first");
        assert_eq!(decode(&bytes), Some(picture));
        assert_eq!(decode(&bytes[..bytes.len() - 1]), None);
        assert_eq!(decode(b"PF\n0 3\n-1.0\n"), None);
    }

    #[test]
    fn grey_becomes_a_color() {
        let bytes = [b"Pf\n1 1\n-1.0\n".as_slice(), &2.0_f32.to_le_bytes()].concat();
        assert_eq!(decode(&bytes), Some(Picture { size: [1, 1], pixels: vec![[2.0; 3]] }));
    }
}
