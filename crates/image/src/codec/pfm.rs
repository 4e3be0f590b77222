//! Portable float maps: a header of text, then rows of floats from the bottom up.

use crate::{Bitmap, ImageError, Limits, Picture, Samples};

const FORMAT: &str = "PFM";

/// Longest header that is looked through for its fields.
const HEADER_LIMIT: usize = 256;

/// What a header says.
struct Header {
    width: u32,
    height: u32,
    channels: u32,
    /// The magnitude scales all values; negative means little endian.
    scale: f32,
    /// Where the samples begin.
    length: usize,
}

/// Reads a grey (`Pf`) or RGB (`PF`) map of either byte order. Values are multiplied by the
/// magnitude of the header's scale.
pub(super) fn decode(bytes: &[u8], limits: &Limits) -> Result<Bitmap, ImageError> {
    let header = parse_header(bytes)?;
    let (width, height, channels) = (header.width, header.height, header.channels);
    let count = limits.check(width.into(), height.into(), channels.into(), 4)?;
    let body = &bytes[header.length..];
    let Some(body) = body.get(..count.saturating_mul(4)) else {
        let message = format!("{count} floats are announced, {} are there", body.len() / 4);
        return Err(ImageError::malformed(FORMAT, message));
    };
    let factor = header.scale.abs();
    let convert = |sample: &[u8; 4]| {
        let value = if header.scale < 0.0 {
            f32::from_le_bytes(*sample)
        } else {
            f32::from_be_bytes(*sample)
        };
        value * factor
    };
    let row_bytes = width as usize * channels as usize * 4;
    let rows = body.chunks_exact(row_bytes).rev();
    let samples = rows.flat_map(|row| row.as_chunks().0).map(convert).collect();
    Ok(Bitmap { width, height, channels, samples: Samples::F32(samples), srgb: false })
}

/// Writes the main layer: little endian, grey or RGB, without alpha.
pub(super) fn encode(picture: &Picture) -> Result<Vec<u8>, ImageError> {
    let main = picture.require_main_layer()?;
    let (magic, indices) =
        if main.is_grey { ("Pf", &main.color[..1]) } else { ("PF", &main.color[..]) };
    let mut bytes = format!("{magic}\n{} {}\n-1.0\n", picture.width, picture.height).into_bytes();
    let width = picture.width as usize;
    bytes.reserve(width * picture.height as usize * indices.len() * 4);
    for row in (0..picture.height as usize).rev() {
        for pixel in row * width..(row + 1) * width {
            for &index in indices {
                bytes.extend_from_slice(&picture.channels[index].data[pixel].to_le_bytes());
            }
        }
    }
    Ok(bytes)
}

/// Reads magic, width, height and scale. Exactly one character of white space ends the header.
fn parse_header(bytes: &[u8]) -> Result<Header, ImageError> {
    let malformed = |what: &str| ImageError::malformed(FORMAT, what);
    let head = &bytes[..bytes.len().min(HEADER_LIMIT)];
    let mut position = 0;
    let mut next_field = || {
        let start = position + head[position..].iter().position(|b| !b.is_ascii_whitespace())?;
        let end = start + head[start..].iter().position(|b| b.is_ascii_whitespace())?;
        position = end + 1;
        std::str::from_utf8(&head[start..end]).ok()
    };
    let channels = match next_field() {
        Some("PF") => 3,
        Some("Pf") => 1,
        _ => return Err(malformed("the header does not begin with PF or Pf")),
    };
    let mut size = || next_field()?.parse::<u32>().ok().filter(|&size| size > 0);
    let width = size().ok_or_else(|| malformed("the width is not a positive integer"))?;
    let height = size().ok_or_else(|| malformed("the height is not a positive integer"))?;
    let scale = next_field().and_then(|field| field.parse::<f32>().ok());
    let scale = scale.filter(|scale| scale.is_finite() && *scale != 0.0);
    let scale = scale.ok_or_else(|| malformed("the scale is not a number other than zero"))?;
    Ok(Header { width, height, channels, scale, length: position })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A header, then floats in the given byte order.
    fn file(header: &str, values: &[f32], convert: fn(f32) -> [u8; 4]) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        bytes.extend(values.iter().flat_map(|&value| convert(value)));
        bytes
    }

    #[test]
    fn rows_come_from_the_bottom_up_in_either_byte_order() {
        let values = [1.0, 2.0, 3.0, 4.0];
        for bytes in [
            file("Pf\n2 2\n-1.0\n", &values, f32::to_le_bytes),
            file("Pf 2\r\n2 1.0\n", &values, f32::to_be_bytes),
        ] {
            let bitmap = decode(&bytes, &Limits::default()).unwrap();
            assert_eq!((bitmap.width, bitmap.height, bitmap.channels), (2, 2, 1));
            assert_eq!(bitmap.samples, Samples::F32(vec![3.0, 4.0, 1.0, 2.0]));
        }
    }

    #[test]
    fn the_scale_multiplies() {
        let bytes = file("PF\n1 1\n-2.5\n", &[1.0, 2.0, 4.0], f32::to_le_bytes);
        let bitmap = decode(&bytes, &Limits::default()).unwrap();
        assert_eq!(bitmap.samples, Samples::F32(vec![2.5, 5.0, 10.0]));
    }

    #[test]
    fn headers_that_lie_are_refused() {
        for header in [
            "PF\n",
            "PF\n0 1\n-1\n",
            "PF\n1 -1\n-1\n",
            "PF\n1 1\n0\n",
            "PF\n1 1\nnan\n",
            "PF\n1 1\n-1",
            "P6\n1 1\n-1\n",
            "PF\n1 1\n-1\n",
            "PF\n99999999999 1\n-1\n",
            "PF\n4000000000 4000000000\n-1\n",
        ] {
            assert!(decode(header.as_bytes(), &Limits::default()).is_err(), "{header:?}");
        }
    }
}
