//! The formats of the `image` crate: PNG, JPEG, BMP, HDR and TIFF, and to read TGA, WebP and QOI.

use std::io::Cursor;

use image::codecs::bmp::BmpEncoder;
use image::codecs::hdr::{HdrDecoder, HdrEncoder};
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::codecs::tiff::TiffEncoder;
use image::{DynamicImage, ImageDecoder, ImageReader};

use super::display::{AlphaMode, display_image};
use super::file_colors::{FileColors, png_colors};
use super::losses::{GREATEST_HDR, LEAST_HDR};
use super::png_chunks;
use crate::numeric::clamp_number;
use crate::{
    Bitmap, EncodeOptions, FileFormat, ImageError, Limits, Picture, PictureHeader, Samples,
};

/// The maximum expansion of any format: deflate reaches a factor of 1032, and a palette of one bit
/// per pixel another 32. A header that claims more is rejected before memory is allocated.
const MAX_EXPANSION: u64 = 1 << 16;

/// Decodes a file of the given format; `name` is the format's name in messages.
pub(super) fn decode(
    bytes: &[u8],
    format: image::ImageFormat,
    name: &'static str,
    limits: &Limits,
) -> Result<Bitmap, ImageError> {
    let mut colors = FileColors::default();
    if format == image::ImageFormat::Png {
        colors = png_colors(bytes);
    } else if format == image::ImageFormat::Qoi && bytes.get(QOI_COLOR_SPACE) == Some(&1) {
        colors.is_linear = true;
    }
    let mut decoder = open(bytes, format, name, limits)?;
    if let Ok(Some(profile)) = decoder.icc_profile() {
        colors.read_profile(&profile);
    }
    let mut bitmap = Context { name, file_size: bytes.len(), limits }.read(decoder)?;
    colors.apply(&mut bitmap);
    Ok(bitmap)
}

/// The size that the header of a file announces.
pub(super) fn read_header(
    bytes: &[u8],
    format: image::ImageFormat,
    name: &'static str,
    limits: &Limits,
) -> Result<PictureHeader, ImageError> {
    let decoder = open(bytes, format, name, limits)?;
    Context { name, file_size: bytes.len(), limits }.check_size(&decoder)?;
    let (width, height) = decoder.dimensions();
    let decoded_bytes = decoder.total_bytes();
    // The decoder of TIFF copies all samples at the end; the others write them where they stay.
    let copies = if format == image::ImageFormat::Tiff { 2 } else { 1 };
    let decoding_bytes = decoded_bytes.saturating_mul(copies);
    Ok(PictureHeader { width, height, decoded_bytes, decoding_bytes })
}

/// Reads the header of a file.
fn open<'a>(
    bytes: &'a [u8],
    format: image::ImageFormat,
    name: &'static str,
    limits: &Limits,
) -> Result<Box<dyn ImageDecoder + 'a>, ImageError> {
    if format == image::ImageFormat::Hdr {
        // Files that start with "#?RGBE" are as common as "#?RADIANCE", which the strict decoder
        // requires.
        let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes));
        return Ok(Box::new(decoder.map_err(|error| read_error(name, error))?));
    }
    if format == image::ImageFormat::Png {
        check_palette(bytes)?;
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(decoder_limits(limits));
    Ok(Box::new(reader.into_decoder().map_err(|error| read_error(name, error))?))
}

/// The place of the byte that says whether a QOI file is linear.
const QOI_COLOR_SPACE: usize = 13;

/// Rejects a PNG file whose palette contains a partial colour: the decoder would read past its end
/// (found by fuzzing, in version 0.18.1 of `png`).
fn check_palette(bytes: &[u8]) -> Result<(), ImageError> {
    let is_partial = |(kind, length, _)| kind == *b"PLTE" && !usize::is_multiple_of(length, 3);
    if png_chunks::chunks(bytes).any(is_partial) {
        return Err(ImageError::malformed("PNG", "the palette ends with a partial colour"));
    }
    Ok(())
}

/// Constraints on a decoder.
struct Context<'a> {
    name: &'static str,
    file_size: usize,
    limits: &'a Limits,
}

impl Context<'_> {
    /// Decodes all samples, after checking that their number is plausible.
    fn read(&self, decoder: impl ImageDecoder) -> Result<Bitmap, ImageError> {
        self.check_size(&decoder)?;
        let image = DynamicImage::from_decoder(decoder);
        let image = image.map_err(|error| read_error(self.name, error))?;
        into_bitmap(image).ok_or_else(|| ImageError::unsupported(self.name, "this sample format"))
    }

    /// Checks the size in the header against the limits and the size of the file.
    fn check_size(&self, decoder: &impl ImageDecoder) -> Result<(), ImageError> {
        let (width, height) = decoder.dimensions();
        let color = decoder.color_type();
        let channels = u64::from(color.channel_count());
        let sample_bytes = u64::from(color.bytes_per_pixel()) / channels.max(1);
        self.limits.check(width.into(), height.into(), channels, sample_bytes)?;
        if width == 0 || height == 0 {
            return Err(ImageError::malformed(self.name, "the image has no pixels"));
        }
        if decoder.total_bytes() > (self.file_size as u64).saturating_mul(MAX_EXPANSION) {
            let message = format!("{} bytes cannot hold {width}x{height} pixels", self.file_size);
            return Err(ImageError::malformed(self.name, message));
        }
        Ok(())
    }
}

/// Encodes the main layer.
pub(super) fn encode(
    picture: &Picture,
    format: FileFormat,
    options: &EncodeOptions,
) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    let mut target = Cursor::new(&mut bytes);
    let display = |mode| display_image(picture, options, mode);
    let result = match format {
        FileFormat::Png => {
            // On four renders, the default compression gave files that were 11 to 18 % smaller, in
            // 2 to 20 times the time; the best 13 to 23 %, in 28 to 220 times.
            let (compression, filter) = (CompressionType::Fast, FilterType::Adaptive);
            let encoder = PngEncoder::new_with_quality(target, compression, filter);
            display(AlphaMode::Straight)?.write_with_encoder(encoder)
        }
        FileFormat::Tiff => without_grey_alpha(display(AlphaMode::Straight)?)
            .write_with_encoder(TiffEncoder::new(target)),
        FileFormat::Jpeg => {
            let quality = options.jpeg_quality.clamp(1, 100);
            let encoder = JpegEncoder::new_with_quality(target, quality);
            display(AlphaMode::Dropped)?.write_with_encoder(encoder)
        }
        FileFormat::Bmp => {
            display(AlphaMode::Dropped)?.write_with_encoder(BmpEncoder::new(&mut target))
        }
        FileFormat::Hdr => linear_image(picture)?.write_with_encoder(HdrEncoder::new(target)),
        FileFormat::Exr | FileFormat::Pfm | FileFormat::Npy | FileFormat::Npz => {
            return Err(ImageError::invalid_picture("this format has a separate encoder"));
        }
    };
    result.map_err(|error| ImageError::invalid_picture(error.to_string()))?;
    Ok(if format == FileFormat::Png { png_chunks::annotate(bytes, picture) } else { bytes })
}

/// Converts our limits to those of the decoders.
fn decoder_limits(limits: &Limits) -> image::Limits {
    let mut decoder_limits = image::Limits::default();
    decoder_limits.max_alloc = Some(limits.bytes);
    decoder_limits
}

/// Converts grey with alpha to colour with alpha, because the TIFF encoder does not support it.
fn without_grey_alpha(image: DynamicImage) -> DynamicImage {
    match image {
        DynamicImage::ImageLumaA8(_) => image.to_rgba8().into(),
        DynamicImage::ImageLumaA16(_) => image.to_rgba16().into(),
        image => image,
    }
}

/// Takes over the samples. `None` for sample formats that no enabled decoder returns.
fn into_bitmap(image: DynamicImage) -> Option<Bitmap> {
    let (width, height) = (image.width(), image.height());
    let channels = u32::from(image.color().channel_count());
    let samples = match image {
        DynamicImage::ImageLuma8(buffer) => Samples::U8(buffer.into_raw()),
        DynamicImage::ImageLumaA8(buffer) => Samples::U8(buffer.into_raw()),
        DynamicImage::ImageRgb8(buffer) => Samples::U8(buffer.into_raw()),
        DynamicImage::ImageRgba8(buffer) => Samples::U8(buffer.into_raw()),
        DynamicImage::ImageLuma16(buffer) => Samples::U16(buffer.into_raw()),
        DynamicImage::ImageLumaA16(buffer) => Samples::U16(buffer.into_raw()),
        DynamicImage::ImageRgb16(buffer) => Samples::U16(buffer.into_raw()),
        DynamicImage::ImageRgba16(buffer) => Samples::U16(buffer.into_raw()),
        DynamicImage::ImageRgb32F(buffer) => Samples::F32(buffer.into_raw()),
        DynamicImage::ImageRgba32F(buffer) => Samples::F32(buffer.into_raw()),
        _ => return None,
    };
    let srgb = matches!(samples, Samples::U8(_) | Samples::U16(_));
    Some(Bitmap { width, height, channels, samples, srgb, ..Bitmap::default() })
}

/// The main layer as linear RGB, within what Radiance HDR can hold: the encoder does not check.
fn linear_image(picture: &Picture) -> Result<DynamicImage, ImageError> {
    let mut color = picture.to_color_image()?;
    for pixel in &mut color.pixels {
        *pixel = pixel.map(|value| clamp_number(value, 0.0, GREATEST_HDR));
        if pixel.iter().all(|value| *value < LEAST_HDR) {
            *pixel = [0.0; 3];
        }
    }
    let values = color.pixels.into_flattened();
    let buffer = image::Rgb32FImage::from_raw(picture.width, picture.height, values);
    let buffer = buffer.ok_or_else(|| ImageError::invalid_picture("it has too few pixels"))?;
    Ok(DynamicImage::ImageRgb32F(buffer))
}

/// Classifies a decoder's error, and keeps the innermost message: the outer ones repeat the
/// format's name.
fn read_error(name: &'static str, error: image::ImageError) -> ImageError {
    let is_unsupported = matches!(error, image::ImageError::Unsupported(_));
    let mut innermost: &dyn std::error::Error = &error;
    while let Some(source) = innermost.source() {
        innermost = source;
    }
    let message = innermost.to_string();
    let message = message.trim();
    if is_unsupported {
        ImageError::unsupported(name, message)
    } else {
        ImageError::malformed(name, message)
    }
}
