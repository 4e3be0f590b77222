//! Encoding options.

use crate::tone_map::ToneMap;

/// The compression of OpenEXR files; both settings are lossless.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ExrCompression {
    /// No compression: fastest to write.
    None,
    /// Deflate over blocks of sixteen rows ("ZIP").
    #[default]
    Zip,
}

/// The sample type of the channels in an OpenEXR file.
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

/// Options of [`encode`](crate::encode). Every format uses the fields that apply to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncodeOptions {
    /// OpenEXR: the compression.
    pub exr_compression: ExrCompression,
    /// OpenEXR: the sample type.
    pub exr_precision: ExrPrecision,
    /// JPEG: the quality, from 1 (smallest file) to 100 (best).
    pub jpeg_quality: u8,
    /// PNG and TIFF: bits per sample.
    pub bit_depth: BitDepth,
    /// Formats with 8 or 16 bits: the tone mapping, after exposure.
    pub tone_map: ToneMap,
    /// Formats with 8 or 16 bits: the exposure in stops; one more stop doubles all values.
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
