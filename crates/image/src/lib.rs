//! Bitmaps, codecs, error metrics and tone mapping.
//!
//! There are three forms of an image:
//!
//! - [`Bitmap`]: interleaved samples as stored in a file, for textures ([`decode`]).
//! - [`Picture`]: named planar `f32` channels with metadata. Films are written from it
//!   ([`encode`]), and comparisons read it ([`decode_exr_layers`], [`decode_picture`]).
//! - [`ColorImage`]: linear RGB triples, for [`metrics`] and tone mapping.
//!
//! Bytes in, bytes out; this crate opens no files. Readers compare the sizes in a header with the
//! size of the file and with [`Limits`] before they allocate.
//!
//! ```
//! use etendue_image::{EncodeOptions, FileFormat, Picture, ToneMap, decode, encode};
//!
//! let mut picture = Picture::new(2, 1);
//! for name in ["R", "G", "B"] {
//!     picture.push(name, vec![0.5, 8.0]);
//! }
//! let options = EncodeOptions { tone_map: ToneMap::Agx, ..EncodeOptions::default() };
//! let png = encode(&picture, FileFormat::Png, &options)?;
//! assert_eq!(decode(&png, "picture.png")?.channels, 3);
//! # Ok::<(), etendue_image::ImageError>(())
//! ```
//!
//! Linear values are relative to the primaries and white of ITU-R BT.709 (sRGB).
#![forbid(unsafe_code)]

mod bitmap;
mod codec;
mod color_image;
mod color_map;
mod error;
mod format;
mod limits;
pub mod metrics;
mod numeric;
mod picture;
mod primaries;
pub mod srgb;
mod tone_map;

pub use bitmap::{Bitmap, Samples};
pub use codec::{
    BitDepth, EncodeOptions, ExrCompression, ExrPrecision, PictureHeader, decode,
    decode_exr_layers, decode_exr_layers_with_limits, decode_picture, decode_with_limits, encode,
    losses, metadata, read_header,
};
pub use color_image::ColorImage;
pub use error::ImageError;
pub use format::FileFormat;
pub use limits::Limits;
pub use picture::{Channel, MainLayer, MetadataValue, Picture, Window};
pub use tone_map::{ToneMap, exposure_scale};
