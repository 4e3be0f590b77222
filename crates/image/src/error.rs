//! Image errors.

use std::fmt;

/// Why an image cannot be read, written or compared.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImageError {
    /// Neither the content nor the extension belongs to a supported format.
    UnknownFormat {
        /// The name that was given with the bytes.
        name: String,
    },
    /// The bytes violate their format, or end too early.
    Malformed {
        /// The name of the format, such as `"PNG"`.
        format: &'static str,
        /// The defect.
        message: String,
    },
    /// The file uses a feature of its format that is not supported.
    Unsupported {
        /// The name of the format, such as `"OpenEXR"`.
        format: &'static str,
        /// The feature.
        message: String,
    },
    /// The image exceeds the [`Limits`](crate::Limits).
    TooLarge {
        /// The limited quantity, such as `"samples"`.
        what: &'static str,
        /// The amount that the image needs.
        requested: u64,
        /// The maximum amount.
        allowed: u64,
    },
    /// There is no memory for the samples.
    NoMemory {
        /// The bytes that they need.
        bytes: u64,
    },
    /// The picture to be written is inconsistent, or does not fit the format.
    InvalidPicture {
        /// The problem.
        message: String,
    },
    /// Two images to be compared differ in size.
    SizeMismatch {
        /// Width and height of the image, in pixels.
        image: (u32, u32),
        /// Width and height of the reference, in pixels.
        reference: (u32, u32),
    },
}

impl ImageError {
    /// A malformed file of `format`.
    pub(crate) fn malformed(format: &'static str, message: impl Into<String>) -> Self {
        Self::Malformed { format, message: message.into() }
    }

    /// An unsupported feature of `format`.
    pub(crate) fn unsupported(format: &'static str, message: impl Into<String>) -> Self {
        Self::Unsupported { format, message: message.into() }
    }

    /// A picture that cannot be written.
    pub(crate) fn invalid_picture(message: impl Into<String>) -> Self {
        Self::InvalidPicture { message: message.into() }
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownFormat { name } => {
                write!(formatter, "`{name}` is in none of the picture formats that are supported")
            }
            Self::Malformed { format, message } => write!(formatter, "broken {format}: {message}"),
            Self::Unsupported { format, message } => {
                write!(formatter, "unsupported {format}: {message}")
            }
            Self::TooLarge { what, requested, allowed } => {
                write!(formatter, "image too large: {requested} {what}, the limit is {allowed}")
            }
            Self::NoMemory { bytes } => {
                write!(formatter, "no memory for {bytes} bytes of samples")
            }
            Self::InvalidPicture { message } => {
                write!(formatter, "the picture cannot be written: {message}")
            }
            Self::SizeMismatch { image, reference } => write!(
                formatter,
                "sizes differ: the image has {}x{} pixels, the reference {}x{}",
                image.0, image.1, reference.0, reference.1
            ),
        }
    }
}

impl std::error::Error for ImageError {}
