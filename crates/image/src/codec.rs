//! Image files as bytes: decoding and encoding.

mod common;
mod display;
mod exr_part;
mod exr_read;
mod exr_write;
mod options;
mod pfm;

pub use options::{BitDepth, EncodeOptions, ExrCompression, ExrPrecision};

use crate::format::{SourceFormat, recognize};
use crate::{Bitmap, FileFormat, ImageError, Limits, Picture};

/// Decodes a PNG, JPEG, BMP, TGA, Radiance HDR, OpenEXR, PFM or TIFF file within the default
/// [`Limits`].
///
/// The content determines the format. `file_name_hint` is only for TGA, which may have no signature.
/// For OpenEXR, this reads the [main layer](Picture::main_layer) of the first part over its data
/// window.
///
/// # Errors
/// [`ImageError`] for an unknown format, a malformed or unsupported file, or an image that is too
/// large.
pub fn decode(bytes: &[u8], file_name_hint: &str) -> Result<Bitmap, ImageError> {
    decode_with_limits(bytes, file_name_hint, &Limits::default())
}

/// The size of a picture, as its header announces it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureHeader {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// The bytes of the samples that [`decode`] returns.
    pub decoded_bytes: u64,
    /// The bytes that [`decode`] needs at its peak.
    pub decoding_bytes: u64,
}

/// Reads the header of a file without decoding its samples, within the default [`Limits`].
///
/// # Errors
/// As [`decode`], as far as the header tells.
pub fn read_header(bytes: &[u8], file_name_hint: &str) -> Result<PictureHeader, ImageError> {
    let limits = &Limits::default();
    match recognize(bytes, file_name_hint) {
        Some(SourceFormat::Exr) => exr_part::read_header(bytes, limits),
        Some(SourceFormat::Pfm) => pfm::read_header(bytes, limits),
        Some(SourceFormat::Common(format, name)) => {
            common::read_header(bytes, format, name, limits)
        }
        None => Err(ImageError::UnknownFormat { name: file_name_hint.to_owned() }),
    }
}

/// [`decode`] with custom limits.
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

/// Decodes all channels and all metadata of the first part of an OpenEXR file, within the default
/// [`Limits`]. Integer channels become floats, which is exact up to 2²⁴.
///
/// # Errors
/// [`ImageError`] for another format, a malformed file, deep data, subsampled channels, or an image
/// that is too large.
pub fn decode_exr_layers(bytes: &[u8]) -> Result<Picture, ImageError> {
    decode_exr_layers_with_limits(bytes, &Limits::default())
}

/// [`decode_exr_layers`] with custom limits.
///
/// # Errors
/// As [`decode_exr_layers`].
pub fn decode_exr_layers_with_limits(bytes: &[u8], limits: &Limits) -> Result<Picture, ImageError> {
    exr_read::decode_picture(bytes, limits)
}

/// Decodes any format to a [`Picture`] of linear channels: all channels of an OpenEXR file, or `R`,
/// `G`, `B` or `Y`, and `A`, of the others.
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

/// Encodes a picture in a file format.
///
/// OpenEXR keeps all channels and metadata. The other formats keep the
/// [main layer](Picture::main_layer): PFM and HDR as linear values, the rest sRGB encoded after
/// [exposure](EncodeOptions::exposure) and [tone mapping](EncodeOptions::tone_map). PNG and TIFF
/// keep alpha. Their colours are not premultiplied, so colours are divided by alpha. NaN becomes
/// zero in these formats.
///
/// The bytes depend only on the arguments: the same picture gives the same file.
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
