//! Encodes OpenEXR files: one part, rows from top to bottom, uncompressed or ZIP.
//!
//! The `exr` crate's writer is not used, because it keeps attributes in a randomly seeded hash map,
//! so the same picture would give different files, and because its deflate takes several times as
//! long. The format is described in "OpenEXR File Layout" (openexr.com).

use flate2::{Compress, Compression, FlushCompress, Status};
use half::f16;
use half::slice::HalfFloatSliceExt;
use rayon::prelude::*;

use super::options::{EncodeOptions, ExrCompression, ExrPrecision};
use crate::primaries::BT709;
use crate::{ImageError, MetadataValue, Picture};

/// Files with fewer bytes of samples are compressed on one thread.
const PARALLEL_BYTES: usize = 1 << 17;

/// The deflate level. On renders with some hundred samples per pixel, 32-bit floats shrink by 3 % at
/// level 2, and by 1 % at level 1 in half the time; higher levels gain nothing more. Smooth
/// textures shrink to 52 % at level 2, 69 % at level 1, and 50 % at level 6 (in 2.4 times the time).
const DEFLATE_LEVEL: u32 = 2;

/// The maximum length of names in bytes; names above 31 bytes need a flag in the version field.
const MAX_NAME_LENGTH: usize = 255;

/// Attributes that describe the file itself. The writer sets them; metadata must not.
pub(super) const STRUCTURAL: [&str; 14] = [
    "channels",
    "chunkCount",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "maxSamplesPerPixel",
    "name",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "tiles",
    "type",
    "version",
];

/// Encodes all channels, sorted by name as the format requires, and all metadata.
pub(super) fn encode(picture: &Picture, options: &EncodeOptions) -> Result<Vec<u8>, ImageError> {
    let mut order: Vec<usize> = (0..picture.channels.len()).collect();
    order.sort_by_key(|&index| picture.channels[index].name.as_bytes());
    let layout = Layout { picture, order, options };
    layout.check()?;

    let mut file = layout.header()?;
    let chunks = layout.chunks();
    let mut offset = file.len() as u64 + 8 * chunks.len() as u64;
    file.reserve(chunks.iter().map(|chunk| chunk.len() + 8).sum());
    for chunk in &chunks {
        file.extend_from_slice(&offset.to_le_bytes());
        offset += chunk.len() as u64;
    }
    for chunk in &chunks {
        file.extend_from_slice(chunk);
    }
    Ok(file)
}

/// A picture and its layout in the file.
struct Layout<'a> {
    picture: &'a Picture,
    /// Indices of the channels in the order of their names.
    order: Vec<usize>,
    options: &'a EncodeOptions,
}

impl Layout<'_> {
    fn sample_bytes(&self) -> usize {
        match self.options.exr_precision {
            ExrPrecision::Half => 2,
            ExrPrecision::Float => 4,
        }
    }

    fn rows_per_chunk(&self) -> usize {
        match self.options.exr_compression {
            ExrCompression::None => 1,
            ExrCompression::Zip => 16,
        }
    }

    /// The size of one row of all channels in bytes.
    fn row_bytes(&self) -> usize {
        self.picture.width as usize * self.order.len() * self.sample_bytes()
    }

    /// Checks that the picture fits the format.
    fn check(&self) -> Result<(), ImageError> {
        if self.order.is_empty() {
            return Err(ImageError::invalid_picture("it has no channels"));
        }
        let chunk_bytes = self.row_bytes().saturating_mul(self.rows_per_chunk());
        if chunk_bytes > i32::MAX as usize {
            return Err(ImageError::invalid_picture("a block of rows takes more than 2 GiB"));
        }
        for channel in &self.picture.channels {
            check_name("a channel", &channel.name)?;
        }
        for (name, _) in &self.picture.metadata {
            check_name("an attribute", name)?;
            if STRUCTURAL.contains(&name.as_str()) {
                let message = format!("the attribute '{name}' describes the file itself");
                return Err(ImageError::invalid_picture(message));
            }
        }
        Ok(())
    }

    /// The magic number, the version, and all attributes.
    fn header(&self) -> Result<Vec<u8>, ImageError> {
        let picture = self.picture;
        let names = picture.channels.iter().map(|channel| &channel.name);
        let has_long_names =
            names.chain(picture.metadata.iter().map(|(name, _)| name)).any(|name| name.len() > 31);
        let mut file = vec![0x76, 0x2f, 0x31, 0x01, 2, if has_long_names { 4 } else { 0 }, 0, 0];

        let [left, top] = picture.data_origin;
        let data = window(left, top, picture.width, picture.height)?;
        let display = picture.display_window;
        let display = window(display.x, display.y, display.width, display.height)?;
        let compression = match self.options.exr_compression {
            ExrCompression::None => 0,
            ExrCompression::Zip => 3,
        };
        attribute(&mut file, "channels", "chlist", &self.channel_list());
        if picture.metadata("chromaticities").is_none() {
            attribute(&mut file, "chromaticities", "chromaticities", &floats(&BT709));
        }
        attribute(&mut file, "compression", "compression", &[compression]);
        attribute(&mut file, "dataWindow", "box2i", &data);
        attribute(&mut file, "displayWindow", "box2i", &display);
        attribute(&mut file, "lineOrder", "lineOrder", &[0]);
        attribute(&mut file, "pixelAspectRatio", "float", &floats(&[1.0]));
        attribute(&mut file, "screenWindowCenter", "v2f", &floats(&[0.0, 0.0]));
        attribute(&mut file, "screenWindowWidth", "float", &floats(&[1.0]));
        for (name, value) in &picture.metadata {
            let (kind, bytes) = attribute_bytes(value);
            if i32::try_from(bytes.len()).is_err() {
                let message = format!("the attribute '{name}' takes more than 2 GiB");
                return Err(ImageError::invalid_picture(message));
            }
            attribute(&mut file, name, kind, &bytes);
        }
        file.push(0);
        Ok(file)
    }

    /// The value of the attribute `channels`. Per channel: its name, sample type, a flag for lossy
    /// compression, three reserved bytes, and the sampling in x and y.
    fn channel_list(&self) -> Vec<u8> {
        let kind: i32 = match self.options.exr_precision {
            ExrPrecision::Half => 1,
            ExrPrecision::Float => 2,
        };
        let mut bytes = Vec::new();
        for &index in &self.order {
            bytes.extend_from_slice(self.picture.channels[index].name.as_bytes());
            bytes.push(0);
            for number in [kind, 0, 1, 1] {
                bytes.extend_from_slice(&number.to_le_bytes());
            }
        }
        bytes.push(0);
        bytes
    }

    /// All chunks, each with its header: the y of the first row, and the number of bytes that follow.
    fn chunks(&self) -> Vec<Vec<u8>> {
        let rows_per_chunk = self.rows_per_chunk();
        let height = self.picture.height as usize;
        let count = height.div_ceil(rows_per_chunk);
        let chunk = |index: usize| {
            let first = index * rows_per_chunk;
            self.chunk(first, (first + rows_per_chunk).min(height))
        };
        if self.row_bytes() * height < PARALLEL_BYTES {
            (0..count).map(chunk).collect()
        } else {
            (0..count).into_par_iter().map(chunk).collect()
        }
    }

    /// The chunk of the rows `first..end`.
    fn chunk(&self, first: usize, end: usize) -> Vec<u8> {
        let raw = self.raw_rows(first, end);
        let compressed = match self.options.exr_compression {
            ExrCompression::None => None,
            ExrCompression::Zip => deflate(&reorder_and_difference(&raw)),
        };
        // The format requires data that compression does not shorten to be stored uncompressed.
        let body = compressed.unwrap_or(raw);
        // Inside the data window, whose corners have been checked.
        let y = (i64::from(self.picture.data_origin[1]) + first as i64) as i32;
        let mut chunk = Vec::with_capacity(body.len() + 8);
        chunk.extend_from_slice(&y.to_le_bytes());
        // `check` ensures that a chunk is smaller than 2 GiB.
        chunk.extend_from_slice(&(body.len() as u32).to_le_bytes());
        chunk.extend_from_slice(&body);
        chunk
    }

    /// The samples of the rows `first..end`: row by row, and channel by channel in each row.
    fn raw_rows(&self, first: usize, end: usize) -> Vec<u8> {
        let width = self.picture.width as usize;
        let mut raw = Vec::with_capacity(self.row_bytes() * (end - first));
        let mut halves = vec![f16::ZERO; width];
        for row in first..end {
            for &index in &self.order {
                let values = &self.picture.channels[index].data[row * width..(row + 1) * width];
                match self.options.exr_precision {
                    ExrPrecision::Float => {
                        raw.extend(values.iter().flat_map(|value| value.to_le_bytes()));
                    }
                    ExrPrecision::Half => {
                        halves.convert_from_f32_slice(values);
                        let pairs = halves.iter().zip(values);
                        raw.extend(pairs.flat_map(|(&half, &value)| {
                            if half.is_infinite() && value.is_finite() {
                                f16::MAX.copysign(half).to_le_bytes()
                            } else {
                                half.to_le_bytes()
                            }
                        }));
                    }
                }
            }
        }
        raw
    }
}

/// Checks the length of a name, and that it has no zero byte, which would terminate it.
fn check_name(what: &str, name: &str) -> Result<(), ImageError> {
    if name.is_empty() || name.len() > MAX_NAME_LENGTH || name.contains('\0') {
        let message = format!(
            "{name:?} is not a name for {what}: names have 1 to 255 bytes, none of them zero"
        );
        return Err(ImageError::invalid_picture(message));
    }
    Ok(())
}

/// The value of a `box2i`: the coordinates of the first and the last pixel, inclusive.
fn window(x: i32, y: i32, width: u32, height: u32) -> Result<Vec<u8>, ImageError> {
    let last = |start: i32, size: u32| i32::try_from(i64::from(start) + i64::from(size) - 1).ok();
    let corners = last(x, width).zip(last(y, height));
    let (right, bottom) = corners
        .ok_or_else(|| ImageError::invalid_picture("its window exceeds 32-bit coordinates"))?;
    Ok([x, y, right, bottom].iter().flat_map(|value| value.to_le_bytes()).collect())
}

/// Appends an attribute: name, type, size, value.
fn attribute(file: &mut Vec<u8>, name: &str, kind: &str, value: &[u8]) {
    file.extend_from_slice(name.as_bytes());
    file.push(0);
    file.extend_from_slice(kind.as_bytes());
    file.push(0);
    // The caller has checked the size of values of variable length.
    file.extend_from_slice(&(value.len() as u32).to_le_bytes());
    file.extend_from_slice(value);
}

/// The type name and the bytes of an attribute's value.
fn attribute_bytes(value: &MetadataValue) -> (&'static str, Vec<u8>) {
    match value {
        MetadataValue::Text(text) => ("string", text.as_bytes().to_vec()),
        MetadataValue::Integer(number) => ("int", number.to_le_bytes().to_vec()),
        MetadataValue::Float(number) => ("float", floats(&[*number])),
        MetadataValue::Double(number) => ("double", number.to_le_bytes().to_vec()),
        MetadataValue::Vector2(vector) => ("v2f", floats(vector)),
        MetadataValue::Vector3(vector) => ("v3f", floats(vector)),
        MetadataValue::Matrix3(matrix) => ("m33f", floats(matrix)),
        MetadataValue::Matrix4(matrix) => ("m44f", floats(matrix)),
        MetadataValue::Chromaticities(points) => ("chromaticities", floats(points)),
    }
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// Prepares bytes for deflate as in OpenEXR's ZIP: bytes at even indices first, then those at odd
/// indices, so that exponents are adjacent. Then each byte is replaced by its difference from the
/// previous one, plus 128.
fn reorder_and_difference(raw: &[u8]) -> Vec<u8> {
    let (even, odd) = (raw.iter().step_by(2), raw.iter().skip(1).step_by(2));
    let mut bytes: Vec<u8> = Vec::with_capacity(raw.len());
    bytes.extend(even.chain(odd));
    for index in (1..bytes.len()).rev() {
        bytes[index] = bytes[index].wrapping_sub(bytes[index - 1]).wrapping_add(128);
    }
    bytes
}

/// Compresses bytes as a zlib stream, or returns `None` if that does not make them shorter.
fn deflate(bytes: &[u8]) -> Option<Vec<u8>> {
    // One byte less than the input: larger output is no gain.
    let mut compressed = Vec::with_capacity(bytes.len().saturating_sub(1));
    let mut compress = Compress::new(Compression::new(DEFLATE_LEVEL), true);
    let status = compress.compress_vec(bytes, &mut compressed, FlushCompress::Finish).ok()?;
    (status == Status::StreamEnd).then_some(compressed)
}
