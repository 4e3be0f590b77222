//! File formats, recognised by extension or by the first bytes of a file.

/// A file format that can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FileFormat {
    /// OpenEXR: all channels and all metadata, linear.
    Exr,
    /// PNG: the main layer, tone mapped and sRGB encoded, 8 or 16 bits.
    Png,
    /// JPEG: the main layer, tone mapped and sRGB encoded, 8 bits, lossy.
    Jpeg,
    /// Radiance HDR: the main layer, linear, with a shared exponent per pixel.
    Hdr,
    /// Portable float map: the main layer, linear.
    Pfm,
    /// BMP: the main layer, tone mapped and sRGB encoded, 8 bits.
    Bmp,
    /// TIFF: the main layer, tone mapped and sRGB encoded, 8 or 16 bits.
    Tiff,
    /// NumPy array: the main layer, linear, as 32-bit floats of shape (height, width, channels).
    Npy,
    /// NumPy archive: an array as in [`Npy`](Self::Npy) for each layer, linear.
    Npz,
}

/// Every writable format with its extensions, the most common one first.
const EXTENSIONS: [(FileFormat, &[&str]); 9] = [
    (FileFormat::Exr, &["exr"]),
    (FileFormat::Png, &["png"]),
    (FileFormat::Jpeg, &["jpg", "jpeg"]),
    (FileFormat::Hdr, &["hdr", "rgbe"]),
    (FileFormat::Pfm, &["pfm"]),
    (FileFormat::Bmp, &["bmp"]),
    (FileFormat::Tiff, &["tif", "tiff"]),
    (FileFormat::Npy, &["npy"]),
    (FileFormat::Npz, &["npz"]),
];

impl FileFormat {
    /// The format with this extension (without the dot, in any case).
    pub fn from_extension(extension: &str) -> Option<Self> {
        let matches = |known: &&str| known.eq_ignore_ascii_case(extension);
        let found = EXTENSIONS.iter().find(|(_, extensions)| extensions.iter().any(matches));
        found.map(|(format, _)| *format)
    }

    /// The extensions of this format without the dot, the most common one first.
    pub fn extensions(self) -> &'static [&'static str] {
        let found = EXTENSIONS.iter().find(|(format, _)| *format == self);
        found.map_or(&[], |(_, extensions)| extensions)
    }

    /// All formats that can be written.
    pub fn all() -> impl Iterator<Item = Self> {
        EXTENSIONS.iter().map(|(format, _)| *format)
    }

    /// Whether files of this format hold unbounded linear values, which are exposed and tone mapped
    /// only for viewing.
    pub fn is_linear(self) -> bool {
        matches!(self, Self::Exr | Self::Hdr | Self::Pfm | Self::Npy | Self::Npz)
    }

    /// Whether colours are stored without being multiplied by alpha.
    pub fn has_straight_alpha(self) -> bool {
        matches!(self, Self::Png | Self::Tiff)
    }

    /// Whether alpha is stored at all.
    pub fn has_alpha(self) -> bool {
        matches!(self, Self::Exr | Self::Png | Self::Tiff | Self::Npy | Self::Npz)
    }
}

/// A file format that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SourceFormat {
    /// OpenEXR.
    Exr,
    /// Portable float map.
    Pfm,
    /// NumPy array.
    Npy,
    /// NumPy archive.
    Npz,
    /// A format that the `image` crate reads; the text is its name in messages.
    Common(image::ImageFormat, &'static str),
}

/// Recognises the format of `bytes` by their content. TGA files without a footer have no signature;
/// they are recognised by the extension of `name`.
pub(crate) fn recognize(bytes: &[u8], name: &str) -> Option<SourceFormat> {
    use image::ImageFormat;
    let starts = |magic: &[u8]| bytes.starts_with(magic);
    let common = |format, name| Some(SourceFormat::Common(format, name));
    if starts(&[0x76, 0x2f, 0x31, 0x01]) {
        Some(SourceFormat::Exr)
    } else if starts(b"\x89PNG\r\n\x1a\n") {
        common(ImageFormat::Png, "PNG")
    } else if starts(&[0xff, 0xd8, 0xff]) {
        common(ImageFormat::Jpeg, "JPEG")
    } else if starts(b"#?") {
        common(ImageFormat::Hdr, "Radiance HDR")
    } else if starts(b"II*\0") || starts(b"MM\0*") {
        common(ImageFormat::Tiff, "TIFF")
    } else if starts(b"PF") || starts(b"Pf") {
        Some(SourceFormat::Pfm)
    } else if starts(b"\x93NUMPY") {
        Some(SourceFormat::Npy)
    } else if starts(b"PK\x03\x04") {
        Some(SourceFormat::Npz)
    } else if starts(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
        common(ImageFormat::WebP, "WebP")
    } else if starts(b"qoif") {
        common(ImageFormat::Qoi, "QOI")
    } else if bytes.ends_with(b"TRUEVISION-XFILE.\0") || has_tga_extension(name) {
        common(ImageFormat::Tga, "TGA")
    } else if starts(b"BM") {
        common(ImageFormat::Bmp, "BMP")
    } else {
        None
    }
}

/// Whether `name` ends in `.tga`, in any case.
fn has_tga_extension(name: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, extension)| extension.eq_ignore_ascii_case("tga"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_round_trip() {
        for format in FileFormat::all() {
            assert!(!format.extensions().is_empty());
            for extension in format.extensions() {
                assert_eq!(FileFormat::from_extension(extension), Some(format));
                let upper = extension.to_ascii_uppercase();
                assert_eq!(FileFormat::from_extension(&upper), Some(format));
            }
        }
        assert_eq!(FileFormat::from_extension("xcf"), None);
    }

    #[test]
    fn content_takes_precedence_over_the_name() {
        let png = b"\x89PNG\r\n\x1a\n";
        assert!(matches!(recognize(png, "a.tga"), Some(SourceFormat::Common(_, "PNG"))));
        assert!(matches!(recognize(b"??", "a.TGA"), Some(SourceFormat::Common(_, "TGA"))));
        assert_eq!(recognize(b"??", "a.png"), None);
        assert_eq!(recognize(b"", ""), None);
    }
}
