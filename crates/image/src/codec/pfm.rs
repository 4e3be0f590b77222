//! Portable float maps: a text header, then rows of floats from bottom to top.

use crate::{Bitmap, ImageError, Limits, Picture, PictureHeader, Samples};

const FORMAT: &str = "PFM";

/// The maximum length of a header in bytes.
const MAX_HEADER_LENGTH: usize = 256;

/// The fields of a header.
struct Header {
    width: u32,
    height: u32,
    channels: u32,
    /// The magnitude scales all values; the sign is negative for little endian.
    scale: f32,
    /// The length of the header in bytes.
    length: usize,
}

/// Decodes a grey (`Pf`) or RGB (`PF`) map in either byte order. Values are multiplied by the
/// magnitude of the scale in the header.
pub(super) fn decode(bytes: &[u8], limits: &Limits) -> Result<Bitmap, ImageError> {
    let header = parse_header(bytes)?;
    let (width, height, channels) = (header.width, header.height, header.channels);
    let count = limits.check(width.into(), height.into(), channels.into(), 4)?;
    let body = &bytes[header.length..];
    let Some(body) = body.get(..count.saturating_mul(4)) else {
        let message =
            format!("the header announces {count} floats, but the file has {}", body.len() / 4);
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
    Ok(Bitmap { width, height, channels, samples: Samples::F32(samples), ..Bitmap::default() })
}

/// The size that the header announces.
pub(super) fn read_header(bytes: &[u8], limits: &Limits) -> Result<PictureHeader, ImageError> {
    let Header { width, height, channels, .. } = parse_header(bytes)?;
    let count = limits.check(width.into(), height.into(), channels.into(), 4)?;
    let bytes = count as u64 * 4;
    Ok(PictureHeader { width, height, decoded_bytes: bytes, decoding_bytes: bytes })
}

/// Encodes the main layer: little endian, grey or RGB, without alpha.
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

/// Parses magic, width, height and scale. Exactly one whitespace character ends the header.
fn parse_header(bytes: &[u8]) -> Result<Header, ImageError> {
    let malformed = |what: &str| ImageError::malformed(FORMAT, what);
    let head = &bytes[..bytes.len().min(MAX_HEADER_LENGTH)];
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
        _ => return Err(malformed("the header does not start with PF or Pf")),
    };
    let mut size = || next_field()?.parse::<u32>().ok().filter(|&size| size > 0);
    let width = size().ok_or_else(|| malformed("the width is not a positive integer"))?;
    let height = size().ok_or_else(|| malformed("the height is not a positive integer"))?;
    let scale = next_field().and_then(|field| field.parse::<f32>().ok());
    let scale = scale.filter(|scale| scale.is_finite() && *scale != 0.0);
    let scale =
        scale.ok_or_else(|| malformed("the scale is not a finite number other than zero"))?;
    Ok(Header { width, height, channels, scale, length: position })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with a header and floats in the given byte order.
    fn file(header: &str, values: &[f32], convert: fn(f32) -> [u8; 4]) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        bytes.extend(values.iter().flat_map(|&value| convert(value)));
        bytes
    }

    #[test]
    fn rows_are_read_from_bottom_to_top_in_either_byte_order() {
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
    fn values_are_multiplied_by_the_scale() {
        let bytes = file("PF\n1 1\n-2.5\n", &[1.0, 2.0, 4.0], f32::to_le_bytes);
        let bitmap = decode(&bytes, &Limits::default()).unwrap();
        assert_eq!(bitmap.samples, Samples::F32(vec![2.5, 5.0, 10.0]));
    }

    #[test]
    fn invalid_headers_are_rejected() {
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
