//! Reading and writing image files as bytes.

mod common;
mod display;
mod exr_part;
mod exr_read;
mod exr_write;
mod pfm;

use crate::format::{SourceFormat, recognize};
use crate::{Bitmap, FileFormat, ImageError, Limits, Picture, ToneMap};

/// How OpenEXR files are compressed. Both ways lose nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ExrCompression {
    /// Not at all: fastest to write.
    None,
    /// Deflate over blocks of sixteen rows ("ZIP").
    #[default]
    Zip,
}

/// The number type of the channels in an OpenEXR file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ExrPrecision {
    /// 16-bit floats. Finite values beyond ±65504 become ±65504.
    Half,
    /// 32-bit floats.
    #[default]
    Float,
}

/// Bits per sample in formats that offer a choice (PNG, TIFF).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BitDepth {
    /// 8 bits per sample.
    #[default]
    Eight,
    /// 16 bits per sample.
    Sixteen,
}

/// How [`encode`] writes a picture. Every format reads the fields that concern it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncodeOptions {
    /// OpenEXR: how the file is compressed.
    pub exr_compression: ExrCompression,
    /// OpenEXR: the number type of the channels.
    pub exr_precision: ExrPrecision,
    /// JPEG: from 1 (small) to 100 (good).
    pub jpeg_quality: u8,
    /// PNG and TIFF: bits per sample.
    pub bit_depth: BitDepth,
    /// Formats with 8 or 16 bits: how the range of values is compressed, after exposure.
    pub tone_map: ToneMap,
    /// Formats with 8 or 16 bits: exposure in stops; one more doubles all values.
    pub exposure: f32,
}

impl Default for EncodeOptions {
    fn default() -> Self {
        Self {
            exr_compression: ExrCompression::default(),
            exr_precision: ExrPrecision::default(),
            jpeg_quality: 95,
            bit_depth: BitDepth::default(),
            tone_map: ToneMap::None,
            exposure: 0.0,
        }
    }
}

/// Reads a PNG, JPEG, BMP, TGA, Radiance HDR, OpenEXR, PFM or TIFF file within the default
/// [`Limits`].
///
/// The content decides what it is; `file_name_hint` is for TGA, which may have nothing to be known
/// by. Of an OpenEXR file this reads the [main layer](Picture::main_layer) of the first part, over
/// its data window.
///
/// # Errors
/// [`ImageError`]: unknown format, broken or unsupported file, or too large an image.
pub fn decode(bytes: &[u8], file_name_hint: &str) -> Result<Bitmap, ImageError> {
    decode_with_limits(bytes, file_name_hint, &Limits::default())
}

/// [`decode`] within limits of one's own.
///
/// # Errors
/// As [`decode`].
pub fn decode_with_limits(
    bytes: &[u8],
    file_name_hint: &str,
    limits: &Limits,
) -> Result<Bitmap, ImageError> {
    match recognize(bytes, file_name_hint) {
        Some(SourceFormat::Exr) => exr_read::decode_bitmap(bytes, limits),
        Some(SourceFormat::Pfm) => pfm::decode(bytes, limits),
        Some(SourceFormat::Common(format, name)) => common::decode(bytes, format, name, limits),
        None => Err(ImageError::UnknownFormat { name: file_name_hint.to_owned() }),
    }
}

/// Reads all channels and all metadata of an OpenEXR file's first part, within the default
/// [`Limits`]. Integer channels become floats, exact up to 2²⁴.
///
/// # Errors
/// [`ImageError`]: not an OpenEXR file, a broken one, deep data, subsampled channels, or too large.
pub fn decode_exr_layers(bytes: &[u8]) -> Result<Picture, ImageError> {
    decode_exr_layers_with_limits(bytes, &Limits::default())
}

/// [`decode_exr_layers`] within limits of one's own.
///
/// # Errors
/// As [`decode_exr_layers`].
pub fn decode_exr_layers_with_limits(bytes: &[u8], limits: &Limits) -> Result<Picture, ImageError> {
    exr_read::decode_picture(bytes, limits)
}

/// Reads any format as a [`Picture`] of linear channels: all of them from OpenEXR, otherwise `R`,
/// `G`, `B` or `Y`, and `A`.
///
/// # Errors
/// As [`decode`].
pub fn decode_picture(bytes: &[u8], file_name_hint: &str) -> Result<Picture, ImageError> {
    if recognize(bytes, file_name_hint) == Some(SourceFormat::Exr) {
        return decode_exr_layers(bytes);
    }
    let bitmap = decode(bytes, file_name_hint)?;
    let names: &[&str] = match bitmap.channels {
        1 => &["Y"],
        2 => &["Y", "A"],
        3 => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    };
    let mut picture = Picture::new(bitmap.width, bitmap.height);
    let values = bitmap.to_linear();
    for (channel, name) in names.iter().enumerate() {
        let plane = values.iter().skip(channel).step_by(names.len()).copied().collect();
        picture.push(*name, plane);
    }
    Ok(picture)
}

/// Writes a picture as a file of this format.
///
/// OpenEXR keeps every channel and all metadata. Other formats keep the
/// [main layer](Picture::main_layer): PFM and HDR as linear values, the rest after
/// [exposure](EncodeOptions::exposure) and [tone mapping](EncodeOptions::tone_map), sRGB encoded.
/// Alpha is kept by PNG and TIFF, which want colours that are not premultiplied: they are divided
/// by it. There, NaN becomes zero.
///
/// The bytes depend on the arguments alone: the same picture gives the same file.
///
/// # Errors
/// [`ImageError::InvalidPicture`] if the picture is not [valid](Picture::validate) or does not fit
/// the format.
pub fn encode(
    picture: &Picture,
    format: FileFormat,
    options: &EncodeOptions,
) -> Result<Vec<u8>, ImageError> {
    picture.validate()?;
    match format {
        FileFormat::Exr => exr_write::encode(picture, options),
        FileFormat::Pfm => pfm::encode(picture),
        _ => common::encode(picture, format, options),
    }
}
