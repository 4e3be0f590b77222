//! NumPy arrays: a header in the syntax of Python, then numbers.

use half::f16;

use super::channel_names;
use crate::{Bitmap, ImageError, Limits, MainLayer, Picture, PictureHeader, Samples};

/// The format's name in messages.
pub(super) const FORMAT: &str = "NumPy array";

const MAGIC: &[u8] = b"\x93NUMPY";

/// The longest header that is read, in bytes.
const MAX_HEADER: usize = 1 << 16;

/// The bytes at the start of a file that hold its header, whatever it is.
pub(super) const MAX_START: usize = MAX_HEADER + 12;

/// The most channels of an array.
const MAX_CHANNELS: usize = 64;

/// An array of rows, columns and channels.
pub(super) struct Array {
    pub(super) height: u32,
    pub(super) width: u32,
    pub(super) channels: u32,
    /// Row by row, the channels of a pixel side by side.
    pub(super) samples: Samples,
}

/// Decodes an array of shape (height, width) or (height, width, channels), with one to four
/// channels. Floats are linear, unsigned integers are sRGB encoded as in other files.
pub(super) fn decode(bytes: &[u8], limits: &Limits) -> Result<Bitmap, ImageError> {
    let array = decode_array(bytes, limits)?;
    if array.channels > 4 {
        let message = format!("a picture of {} channels", array.channels);
        return Err(ImageError::unsupported(FORMAT, message));
    }
    Ok(array.into_bitmap())
}

/// The size that the header announces. The array may be cut off after it.
pub(super) fn read_header(bytes: &[u8], limits: &Limits) -> Result<PictureHeader, ImageError> {
    let Layout { width, height, length, is_fortran, .. } = Layout::read(bytes, limits)?;
    let decoded_bytes = length as u64;
    let decoding_bytes = decoded_bytes.saturating_mul(if is_fortran { 2 } else { 1 });
    Ok(PictureHeader { width, height, decoded_bytes, decoding_bytes })
}

/// Decodes an array of any number of channels.
pub(super) fn decode_array(bytes: &[u8], limits: &Limits) -> Result<Array, ImageError> {
    let Layout { height, width, channels, kind, length, is_fortran, body } =
        Layout::read(bytes, limits)?;
    let body = body.get(..length).ok_or_else(|| {
        let message = format!("its shape takes {length} bytes, but {} follow", body.len());
        ImageError::malformed(FORMAT, message)
    })?;
    let samples = kind.read(body);
    let array = Array { height, width, channels, samples };
    Ok(if is_fortran { array.transposed() } else { array })
}

/// What the header of an array says.
struct Layout<'a> {
    height: u32,
    width: u32,
    channels: u32,
    kind: Kind,
    /// The bytes of all numbers.
    length: usize,
    /// Whether the first index varies fastest.
    is_fortran: bool,
    /// What follows the header.
    body: &'a [u8],
}

impl<'a> Layout<'a> {
    fn read(bytes: &'a [u8], limits: &Limits) -> Result<Self, ImageError> {
        let (header, body) = split_header(bytes)?;
        let malformed = |what: &str| ImageError::malformed(FORMAT, what);
        let descr = text_value(header, "descr").ok_or_else(|| malformed("it has no `descr`"))?;
        let shape = shape(header).ok_or_else(|| malformed("it has no valid `shape`"))?;
        let (height, width, channels) = match *shape.as_slice() {
            [height, width] => (height, width, 1),
            [height, width, channels] if channels <= MAX_CHANNELS => (height, width, channels),
            _ => {
                let message = format!("the shape {shape:?} instead of (height, width, channels)");
                return Err(ImageError::unsupported(FORMAT, message));
            }
        };
        let side = |side: usize| u32::try_from(side).ok().filter(|side| *side > 0);
        let sides = side(height).zip(side(width)).zip(side(channels));
        let ((height, width), channels) = sides.ok_or_else(|| malformed("it has no pixels"))?;
        let kind = Kind::of(descr).ok_or_else(|| {
            let message =
                format!("the number type `{descr}` instead of floats or unsigned integers");
            ImageError::unsupported(FORMAT, message)
        })?;
        let count = limits.check(width.into(), height.into(), channels.into(), 4)?;
        let length = count.saturating_mul(kind.bytes);
        let is_fortran =
            value(header, "fortran_order").is_some_and(|text| text.starts_with("True"));
        Ok(Self { height, width, channels, kind, length, is_fortran, body })
    }
}

/// Encodes the main layer.
pub(super) fn encode(picture: &Picture) -> Result<Vec<u8>, ImageError> {
    let MainLayer { color, alpha, is_grey } = picture.require_main_layer()?;
    let color = if is_grey { &color[..1] } else { &color[..] };
    Ok(encode_channels(picture, &color.iter().copied().chain(alpha).collect::<Vec<_>>()))
}

/// Encodes some channels as 32-bit floats.
pub(super) fn encode_channels(picture: &Picture, channels: &[usize]) -> Vec<u8> {
    let (width, height) = (picture.width, picture.height);
    let mut header = format!(
        "{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}, {}), }}",
        channels.len()
    );
    // Magic, version, length and header take a multiple of 64 bytes, and a line feed ends them.
    let padding = 63 - (MAGIC.len() + 4 + header.len()) % 64;
    header.extend(std::iter::repeat_n(' ', padding));
    header.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend_from_slice(&[1, 0]);
    // A header takes two or three times 64 bytes.
    bytes.extend_from_slice(&(header.len() as u16).to_le_bytes());
    bytes.extend_from_slice(header.as_bytes());
    let planes: Vec<&[f32]> =
        channels.iter().map(|index| picture.channels[*index].data.as_slice()).collect();
    let pixel_count = width as usize * height as usize;
    bytes.reserve(4 * pixel_count * planes.len());
    for pixel in 0..pixel_count {
        for plane in &planes {
            bytes.extend_from_slice(&plane[pixel].to_le_bytes());
        }
    }
    bytes
}

impl Array {
    pub(super) fn into_bitmap(self) -> Bitmap {
        let Self { height, width, channels, samples } = self;
        let srgb = matches!(samples, Samples::U8(_) | Samples::U16(_));
        Bitmap { width, height, channels, samples, srgb, ..Bitmap::default() }
    }

    /// The names of the channels of a picture.
    pub(super) fn channel_names(&self) -> &'static [&'static str] {
        channel_names(self.channels)
    }

    /// From Fortran's order, where the first index runs fastest, to C's.
    fn transposed(self) -> Self {
        fn reorder<T: Copy>(values: &[T], [height, width, channels]: [usize; 3]) -> Vec<T> {
            let mut ordered = Vec::with_capacity(values.len());
            for y in 0..height {
                for x in 0..width {
                    ordered.extend((0..channels).map(|c| values[y + height * (x + width * c)]));
                }
            }
            ordered
        }
        let shape = [self.height as usize, self.width as usize, self.channels as usize];
        let samples = match &self.samples {
            Samples::U8(values) => Samples::U8(reorder(values, shape)),
            Samples::U16(values) => Samples::U16(reorder(values, shape)),
            Samples::F16(values) => Samples::F16(reorder(values, shape)),
            Samples::F32(values) => Samples::F32(reorder(values, shape)),
        };
        Self { samples, ..self }
    }
}

/// A type of numbers.
struct Kind {
    is_big_endian: bool,
    is_float: bool,
    bytes: usize,
}

impl Kind {
    /// Parses a type such as `<f4`.
    fn of(descr: &str) -> Option<Self> {
        let mut letters = descr.chars();
        let is_big_endian = match letters.next()? {
            '>' => true,
            '<' | '|' | '=' => false,
            _ => return None,
        };
        let (is_float, bytes) = match letters.as_str() {
            "f2" => (true, 2),
            "f4" => (true, 4),
            "f8" => (true, 8),
            "u1" => (false, 1),
            "u2" => (false, 2),
            _ => return None,
        };
        Some(Self { is_big_endian, is_float, bytes })
    }

    fn read(&self, body: &[u8]) -> Samples {
        match (self.is_float, self.bytes) {
            (false, 1) => Samples::U8(body.to_vec()),
            (false, _) => Samples::U16(self.numbers(body, u16::from_le_bytes)),
            (true, 2) => Samples::F16(self.numbers(body, f16::from_le_bytes)),
            (true, 4) => Samples::F32(self.numbers(body, f32::from_le_bytes)),
            (true, _) => Samples::F32(self.numbers(body, |bytes| f64::from_le_bytes(bytes) as f32)),
        }
    }

    fn numbers<const N: usize, T>(&self, body: &[u8], convert: impl Fn([u8; N]) -> T) -> Vec<T> {
        let number = |bytes: &[u8; N]| {
            let mut bytes = *bytes;
            if self.is_big_endian {
                bytes.reverse();
            }
            convert(bytes)
        };
        body.as_chunks().0.iter().map(number).collect()
    }
}

/// The text of the header, and what follows it.
fn split_header(bytes: &[u8]) -> Result<(&str, &[u8]), ImageError> {
    let malformed = || ImageError::malformed(FORMAT, "its header is not valid");
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(malformed)?;
    let (length, start) = match *rest {
        [1, _, a, b, ..] => (usize::from(u16::from_le_bytes([a, b])), 4),
        [2 | 3, _, a, b, c, d, ..] => (u32::from_le_bytes([a, b, c, d]) as usize, 6),
        _ => return Err(malformed()),
    };
    if length > MAX_HEADER {
        return Err(malformed());
    }
    let (header, body) = rest[start..].split_at_checked(length).ok_or_else(malformed)?;
    let header = std::str::from_utf8(header).map_err(|_| malformed())?;
    Ok((header, body))
}

/// What follows a key of the header.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let quoted = [format!("'{key}'"), format!("\"{key}\"")];
    let after = quoted.iter().find_map(|quoted| header.split_once(quoted.as_str()))?.1;
    Some(after.trim_start().strip_prefix(':')?.trim_start())
}

/// A value in quotes.
fn text_value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let value = value(header, key)?;
    let quote = value.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    value[1..].split_once(quote).map(|(text, _)| text)
}

/// The numbers of the shape.
fn shape(header: &str) -> Option<Vec<usize>> {
    let (inside, _) = value(header, "shape")?.strip_prefix('(')?.split_once(')')?;
    let numbers = inside.split(',').map(str::trim).filter(|number| !number.is_empty());
    numbers.map(|number| number.trim_end_matches('L').parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(descr: &str, order: &str, shape: &str, body: &[u8]) -> Vec<u8> {
        let header =
            format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\0".to_vec();
        bytes.extend_from_slice(&(header.len() as u16).to_le_bytes());
        bytes.extend_from_slice(header.as_bytes());
        bytes.extend_from_slice(body);
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Bitmap, ImageError> {
        decode(bytes, &Limits::default())
    }

    #[test]
    fn every_number_type_in_both_byte_orders() {
        let floats = Samples::F32(vec![1.5, -2.0]);
        let doubles: Vec<u8> = [1.5_f64, -2.0].iter().flat_map(|v| v.to_be_bytes()).collect();
        let singles: Vec<u8> = [1.5_f32, -2.0].iter().flat_map(|v| v.to_le_bytes()).collect();
        assert_eq!(read(&file(">f8", "False", "(1, 2)", &doubles)).unwrap().samples, floats);
        assert_eq!(read(&file("<f4", "False", "(1, 2, 1)", &singles)).unwrap().samples, floats);
        let halves = read(&file("<f2", "False", "(1, 1)", &[0, 0x3c])).unwrap();
        assert_eq!(halves.samples, Samples::F16(vec![f16::ONE]));
        let bytes = read(&file("|u1", "False", "(1, 1, 3)", &[1, 2, 3])).unwrap();
        assert!(bytes.srgb && bytes.samples == Samples::U8(vec![1, 2, 3]));
        let words = read(&file(">u2", "False", "(1, 1)", &[1, 2])).unwrap();
        assert_eq!(words.samples, Samples::U16(vec![258]));
    }

    #[test]
    fn fortran_order_is_put_in_order() {
        // Two rows of three pixels with two channels, whose values count up in C's order.
        let body = [0, 6, 2, 8, 4, 10, 1, 7, 3, 9, 5, 11];
        let array = read(&file("|u1", "True", "(2, 3, 2)", &body)).unwrap();
        assert_eq!(array.samples, Samples::U8((0..12).collect()));
    }

    #[test]
    fn what_is_written_is_what_numpy_writes() {
        let mut picture = Picture::new(2, 3);
        for (channel, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
            picture.push(name, (0..6).map(|index| (4 * index + channel) as f32).collect());
        }
        let bytes = encode(&picture).unwrap();
        assert_eq!((bytes.len() - 4 * 24) % 64, 0);
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2, 4), }";
        assert_eq!(&bytes[10..10 + text.len()], text.as_bytes());
        let expected = Samples::F32((0..24).map(|value| value as f32).collect());
        assert_eq!(read(&bytes).unwrap().samples, expected);
    }

    #[test]
    fn malformed_arrays_are_errors() {
        let body = [0; 64];
        for (descr, order, shape) in [
            ("<f4", "False", "(4294967295, 4294967295, 4)"),
            ("<f4", "False", "(99999999999999999999,)"),
            ("<f4", "False", "(0, 3)"),
            ("<f4", "False", "(4, 4, 5)"),
            ("<f4", "False", "(4, 4, 2)"),
            ("<f4", "False", "(2, 2, 2, 2)"),
            ("<f4", "False", "4"),
            ("<i4", "False", "(2, 2)"),
            ("|O", "False", "(2, 2)"),
            ("é", "False", "(2, 2)"),
            ("", "False", "(2, 2)"),
        ] {
            assert!(read(&file(descr, order, shape, &body)).is_err(), "{descr} {shape}");
        }
        let valid = file("<f4", "False", "(2, 2)", &body[..16]);
        assert!(read(&valid).is_ok());
        for length in 0..valid.len() {
            assert!(read(&valid[..length]).is_err(), "{length}");
        }
        let mut long = b"\x93NUMPY\x02\0".to_vec();
        long.extend_from_slice(&u32::MAX.to_le_bytes());
        assert!(read(&long).is_err());
    }
}
