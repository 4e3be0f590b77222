//! Bitmaps, codecs from and to bytes, error metrics and tone mapping.
//!
//! Three forms of an image, by what is done with it:
//!
//! - [`Bitmap`]: interleaved samples as a file held them; what textures are made of ([`decode`]).
//! - [`Picture`]: planar `f32` channels under any names, with metadata; what a film writes
//!   ([`encode`]) and what a comparison reads ([`decode_exr_layers`], [`decode_picture`]).
//! - [`ColorImage`]: linear RGB triples; what [`metrics`] and tone mapping work on.
//!
//! Bytes come in and bytes go out: nothing here opens a file. Every reader holds the sizes that a
//! header claims against the bytes that are there, and against [`Limits`], before memory is taken.
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
pub mod color_map;
mod error;
mod format;
mod limits;
pub mod metrics;
mod numeric;
mod picture;
pub mod srgb;
mod tone_map;

pub use bitmap::{Bitmap, Samples};
pub use codec::{
    BitDepth, EncodeOptions, ExrCompression, ExrPrecision, decode, decode_exr_layers,
    decode_exr_layers_with_limits, decode_picture, decode_with_limits, encode,
};
pub use color_image::ColorImage;
pub use error::ImageError;
pub use format::FileFormat;
pub use limits::Limits;
pub use picture::{Channel, MainLayer, MetadataValue, Picture, Window};
pub use tone_map::{ToneMap, exposure_scale};
