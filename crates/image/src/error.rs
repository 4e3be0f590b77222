//! What can go wrong with an image, by whose fault it is.

use std::fmt;

/// Why an image could not be read, written or compared.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImageError {
    /// Neither the content nor the extension of the name belongs to a format that is read here.
    UnknownFormat {
        /// The name that came with the bytes.
        name: String,
    },
    /// The bytes break the rules of their format, or end too early.
    Malformed {
        /// The format's name, such as `"PNG"`.
        format: &'static str,
        /// What is wrong.
        message: String,
    },
    /// The file may be sound, but uses a part of its format that is not supported.
    Unsupported {
        /// The format's name, such as `"OpenEXR"`.
        format: &'static str,
        /// Which part.
        message: String,
    },
    /// The image asks for more than the [`Limits`](crate::Limits) allow.
    TooLarge {
        /// What there is too much of, such as `"samples"`.
        what: &'static str,
        /// How much the image asks for.
        requested: u64,
        /// How much is allowed.
        allowed: u64,
    },
    /// The picture to be written contradicts itself, or does not fit the chosen format.
    InvalidPicture {
        /// What is wrong.
        message: String,
    },
    /// Two images that are compared differ in size.
    SizeMismatch {
        /// Width and height of the image, in pixels.
        image: (u32, u32),
        /// Width and height of the reference, in pixels.
        reference: (u32, u32),
    },
}

impl ImageError {
    /// A broken file of `format`.
    pub(crate) fn malformed(format: &'static str, message: impl Into<String>) -> Self {
        Self::Malformed { format, message: message.into() }
    }

    /// A part of `format` that is not supported.
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
                write!(formatter, "`{name}` is in none of the picture formats known here")
            }
            Self::Malformed { format, message } => write!(formatter, "broken {format}: {message}"),
            Self::Unsupported { format, message } => {
                write!(formatter, "unsupported {format}: {message}")
            }
            Self::TooLarge { what, requested, allowed } => {
                write!(formatter, "image too large: {requested} {what}, allowed are {allowed}")
            }
            Self::InvalidPicture { message } => {
                write!(formatter, "picture cannot be written: {message}")
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
