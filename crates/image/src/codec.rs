//! Image files as bytes: decoding and encoding.

mod common;
mod display;
mod exr_chroma;
mod exr_part;
mod exr_read;
mod exr_write;
mod file_colors;
mod losses;
mod npy;
mod npz;
mod options;
mod pfm;
mod png_chunks;
mod zip;

pub use losses::losses;
pub use options::{BitDepth, EncodeOptions, ExrCompression, ExrPrecision};

use crate::format::{SourceFormat, recognize};
use crate::{Bitmap, FileFormat, ImageError, Limits, MetadataValue, Picture, Samples};

/// Decodes a PNG, JPEG, BMP, TGA, TIFF, WebP, QOI, Radiance HDR, OpenEXR, PFM or NumPy file within
/// the default [`Limits`].
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
        Some(SourceFormat::Npy) => npy::read_header(bytes, limits),
        Some(SourceFormat::Npz) => npz::read_header(bytes, limits),
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
        Some(SourceFormat::Npy) => npy::decode(bytes, limits),
        Some(SourceFormat::Npz) => npz::decode_bitmap(bytes, limits),
        Some(SourceFormat::Common(format, name)) => common::decode(bytes, format, name, limits),
        None => Err(ImageError::UnknownFormat { name: file_name_hint.to_owned() }),
    }
}

/// Decodes all channels and all metadata of the first part of an OpenEXR file, within the default
/// [`Limits`]. Integer channels become floats, which is exact up to 2²⁴. Luminance and chroma become red,
/// green and blue.
///
/// # Errors
/// [`ImageError`] for another format, a malformed file, deep data, or an image that is too large.
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

/// The metadata of an OpenEXR or PNG file, of which `bytes` may be only the beginning. Empty for
/// other formats, and for headers that are not valid.
///
/// The texts of PNG files have the names that [`encode`] gave them.
pub fn metadata(bytes: &[u8]) -> Vec<(String, MetadataValue)> {
    match recognize(bytes, "") {
        Some(SourceFormat::Exr) => exr_read::metadata_of_file(bytes),
        Some(SourceFormat::Common(image::ImageFormat::Png, _)) => {
            let texts = png_chunks::texts(bytes).into_iter();
            texts.map(|(name, text)| (name, MetadataValue::Text(text))).collect()
        }
        _ => Vec::new(),
    }
}

/// Decodes any format to a [`Picture`] of linear channels relative to the primaries of BT.709: all
/// channels of an OpenEXR file and all arrays of a NumPy archive, or `R`, `G`, `B` or `Y`, and `A`,
/// of the others. The colours of PNG, TIFF, TGA, BMP, WebP and QOI files keep their
/// [straight alpha](Picture::straight_alpha).
///
/// # Errors
/// As [`decode`].
pub fn decode_picture(bytes: &[u8], file_name_hint: &str) -> Result<Picture, ImageError> {
    let format = recognize(bytes, file_name_hint);
    match format {
        Some(SourceFormat::Exr) => {
            let mut picture = decode_exr_layers(bytes)?;
            picture.convert_to_bt709();
            return Ok(picture);
        }
        Some(SourceFormat::Npz) => return npz::decode_picture(bytes, &Limits::default()),
        _ => {}
    }
    let mut bitmap = decode(bytes, file_name_hint)?;
    let is_tiff = matches!(format, Some(SourceFormat::Common(image::ImageFormat::Tiff, _)));
    if is_tiff && file_colors::tiff_has_associated_alpha(bytes) {
        file_colors::divide_by_alpha(&mut bitmap);
    }
    let values = bitmap.to_linear();
    let names = channel_names(bitmap.channels);
    let mut picture = Picture::new(bitmap.width, bitmap.height);
    for (channel, name) in names.iter().enumerate() {
        let plane = values.iter().skip(channel).step_by(names.len()).copied().collect();
        picture.push(*name, plane);
    }
    picture.straight_alpha = bitmap.has_alpha() && matches!(format, Some(SourceFormat::Common(..)));
    picture.source_depth = match bitmap.samples {
        Samples::U8(_) => Some(BitDepth::Eight),
        Samples::U16(_) => Some(BitDepth::Sixteen),
        Samples::F16(_) | Samples::F32(_) => None,
    };
    picture.warnings = bitmap.warnings;
    picture.metadata = texts(bytes);
    Ok(picture)
}

/// The texts of a PNG file that any format may keep: names that are not those of the file's structure,
/// and the first text of each name.
fn texts(bytes: &[u8]) -> Vec<(String, MetadataValue)> {
    let mut kept: Vec<(String, MetadataValue)> = Vec::new();
    for (name, value) in metadata(bytes) {
        let is_free = !exr_write::STRUCTURAL.contains(&name.as_str());
        if !name.is_empty() && is_free && !kept.iter().any(|(known, _)| *known == name) {
            kept.push((name, value));
        }
    }
    kept
}

/// The names of one to four interleaved channels.
fn channel_names(count: u32) -> &'static [&'static str] {
    match count {
        1 => &["Y"],
        2 => &["Y", "A"],
        3 => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    }
}

/// Encodes a picture in a file format.
///
/// OpenEXR keeps all channels and metadata. The other formats keep the
/// [main layer](Picture::main_layer): PFM, HDR and NumPy arrays as linear values, the rest sRGB
/// encoded after [exposure](EncodeOptions::exposure) and [tone mapping](EncodeOptions::tone_map). PNG
/// and TIFF keep alpha, and their colours are not premultiplied. [`losses`] tells which values a
/// format cannot hold. PNG files keep texts and integers of the metadata.
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
    if picture.straight_alpha && !format.has_straight_alpha() {
        let mut premultiplied = picture.clone();
        premultiplied.premultiply();
        return encode(&premultiplied, format, options);
    }
    match format {
        FileFormat::Exr => exr_write::encode(picture, options),
        FileFormat::Pfm => pfm::encode(picture),
        FileFormat::Npy => npy::encode(picture),
        FileFormat::Npz => npz::encode(picture),
        _ => common::encode(picture, format, options),
    }
}
