//! What files with integer samples say about their colours and alpha.

use super::png_chunks::chunks;
use crate::picture::degenerate_chromaticities;
use crate::primaries::to_bt709;
use crate::{Bitmap, Samples};

/// The colour space of a file, as far as it is followed.
#[derive(Default)]
pub(super) struct FileColors {
    /// Whether the samples are linear instead of sRGB encoded.
    pub(super) is_linear: bool,
    to_bt709: Option<[[f32; 3]; 3]>,
    warnings: Vec<String>,
}

impl FileColors {
    /// Warns of an ICC profile of another colour space than sRGB.
    pub(super) fn read_profile(&mut self, profile: &[u8]) {
        // Names are ASCII in version 2 of the format, and UTF-16 in version 4.
        let narrow = profile.windows(4).any(|bytes| bytes == b"sRGB");
        let wide = profile.windows(8).any(|bytes| bytes == b"\0s\0R\0G\0B");
        if !narrow && !wide {
            self.warnings.push(
                "its colour profile is not followed; the colours are read as sRGB".to_owned(),
            );
        }
    }

    pub(super) fn apply(self, bitmap: &mut Bitmap) {
        bitmap.srgb &= !self.is_linear;
        bitmap.to_bt709 = self.to_bt709.filter(|_| bitmap.channels >= 3);
        bitmap.warnings.extend(self.warnings);
    }
}

/// The gamma of sRGB in a PNG file, in units of 1/100,000.
const SRGB_GAMMA: u32 = 45_455;

/// Follows the chunks `gAMA` and `cHRM` as the PNG specification says: `sRGB`, `iCCP` and `cICP` come
/// before them. Of gammas, 1 is followed, and that of sRGB stands for sRGB.
pub(super) fn png_colors(bytes: &[u8]) -> FileColors {
    let mut colors = FileColors::default();
    let number = |data: &[u8], index: usize| {
        let bytes = data.get(4 * index..4 * index + 4)?;
        Some(u32::from_be_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    };
    let (mut gamma, mut points) = (None, None);
    for (kind, _, data) in chunks(bytes) {
        match &kind {
            b"sRGB" | b"iCCP" => return colors,
            b"cICP" => {
                // BT.709 primaries with the transfer function of sRGB, or of BT.709.
                if !matches!(data, [1, 1 | 13, ..]) {
                    let message = "its chunk cICP is not followed; the colours are read as sRGB";
                    colors.warnings.push(message.to_owned());
                }
                return colors;
            }
            b"gAMA" => gamma = number(data, 0),
            b"cHRM" => {
                let all: Option<Vec<u32>> = (0..8).map(|index| number(data, index)).collect();
                points = all.map(|all| {
                    // White comes first in the file.
                    [2, 3, 4, 5, 6, 7, 0, 1].map(|index| (f64::from(all[index]) / 1e5) as f32)
                });
            }
            b"IDAT" => break,
            _ => {}
        }
    }
    match gamma {
        Some(100_000) => colors.is_linear = true,
        Some(gamma) if gamma.abs_diff(SRGB_GAMMA) > SRGB_GAMMA / 20 => {
            colors.warnings.push(format!(
                "its gamma of {} is not followed; the colours are read as sRGB",
                f64::from(gamma) / 1e5
            ))
        }
        _ => {}
    }
    if let Some(points) = points {
        match to_bt709(&points) {
            Ok(matrix) => colors.to_bt709 = matrix,
            Err(_) => colors.warnings.push(degenerate_chromaticities(&points)),
        }
    }
    colors
}

/// Whether the first image of a TIFF file has colours that are multiplied by alpha: the first of its
/// extra samples is "associated alpha".
pub(super) fn tiff_has_associated_alpha(bytes: &[u8]) -> bool {
    const EXTRA_SAMPLES: u16 = 338;
    const ASSOCIATED: u16 = 1;
    let is_big_endian = bytes.starts_with(b"MM");
    let array = |at: usize| bytes.get(at..at.checked_add(4)?)?.try_into().ok();
    let short = |at: usize| {
        let [a, b, ..]: [u8; 4] = array(at)?;
        Some(if is_big_endian { u16::from_be_bytes([a, b]) } else { u16::from_le_bytes([a, b]) })
    };
    let long = |at: usize| {
        let number: [u8; 4] = array(at)?;
        Some(if is_big_endian { u32::from_be_bytes(number) } else { u32::from_le_bytes(number) })
    };
    let find = || {
        let directory = long(4)? as usize;
        let count = usize::from(short(directory)?);
        let entries = (0..count).map(|index| directory.saturating_add(2 + 12 * index));
        let entry = entries.into_iter().find(|entry| short(*entry) == Some(EXTRA_SAMPLES))?;
        // Up to two values stand in the entry itself; alpha is the only extra sample there is.
        short(entry.saturating_add(8))
    };
    find() == Some(ASSOCIATED)
}

/// Divides encoded colours by alpha, as editors multiply them.
pub(super) fn divide_by_alpha(bitmap: &mut Bitmap) {
    let channels = bitmap.channels as usize;
    if !bitmap.has_alpha() {
        return;
    }
    match &mut bitmap.samples {
        Samples::U8(values) => {
            for pixel in values.chunks_exact_mut(channels) {
                divide(pixel, 255.0, |value| value as u8);
            }
        }
        Samples::U16(values) => {
            for pixel in values.chunks_exact_mut(channels) {
                divide(pixel, 65535.0, |value| value as u16);
            }
        }
        Samples::F16(_) => {}
        Samples::F32(values) => {
            for pixel in values.chunks_exact_mut(channels) {
                divide(pixel, 1.0, |value| value);
            }
        }
    }
}

/// Divides the colours of a pixel by its last channel, of which `one` stands for one.
fn divide<T: Copy + Into<f32>>(pixel: &mut [T], one: f32, convert: fn(f32) -> T) {
    let Some((alpha, colors)) = pixel.split_last_mut() else { return };
    let alpha: f32 = (*alpha).into();
    if alpha > 0.0 {
        // Conversions to integers saturate; floats are not rounded.
        let half = if one > 1.0 { 0.5 } else { 0.0 };
        for color in colors {
            *color = convert((*color).into() * one / alpha + half);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EncodeOptions, FileFormat, Picture, decode, encode};

    /// A PNG file of one colour with these chunks in place of the one that says sRGB.
    fn png_with(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut picture = Picture::new(1, 1);
        for name in ["R", "G", "B"] {
            picture.push(name, vec![0.25]);
        }
        let png = encode(&picture, FileFormat::Png, &EncodeOptions::default()).unwrap();
        // Signature and header take 33 bytes, the chunk sRGB another 13.
        let mut bytes = png[..33].to_vec();
        for (kind, data) in chunks {
            let mut checksum = flate2::Crc::new();
            checksum.update(*kind);
            checksum.update(data);
            bytes.extend_from_slice(&(data.len() as u32).to_be_bytes());
            bytes.extend_from_slice(*kind);
            bytes.extend_from_slice(data);
            bytes.extend_from_slice(&checksum.sum().to_be_bytes());
        }
        bytes.extend_from_slice(&png[46..]);
        bytes
    }

    fn numbers(numbers: &[u32]) -> Vec<u8> {
        numbers.iter().flat_map(|number| number.to_be_bytes()).collect()
    }

    #[test]
    fn linear_png_files_are_linear_and_other_gammas_are_said() {
        let linear = decode(&png_with(&[(b"gAMA", &numbers(&[100_000]))]), "").unwrap();
        assert!(!linear.srgb && linear.warnings.is_empty());
        let usual = decode(&png_with(&[(b"gAMA", &numbers(&[45_455]))]), "").unwrap();
        assert!(usual.srgb && usual.warnings.is_empty());
        let other = decode(&png_with(&[(b"gAMA", &numbers(&[55_000]))]), "").unwrap();
        assert!(other.srgb && other.warnings[0].contains("gamma of 0.55"), "{:?}", other.warnings);
        let gamma = numbers(&[55_000]);
        let both = decode(&png_with(&[(b"sRGB", &[0]), (b"gAMA", &gamma)]), "").unwrap();
        assert!(both.srgb && both.warnings.is_empty());
    }

    #[test]
    fn chromaticities_of_png_files_are_followed() {
        let bt2020 = [31_270, 32_900, 70_800, 29_200, 17_000, 79_700, 13_100, 4_600];
        let bitmap = decode(&png_with(&[(b"cHRM", &numbers(&bt2020))]), "").unwrap();
        assert!(bitmap.to_bt709.is_some_and(|matrix| (matrix[0][0] - 1.6605).abs() < 1e-3));
        // Grey stays grey, as the whites are the same.
        let color = bitmap.to_color_image().pixels[0];
        assert!(color.iter().all(|value| (value - 0.25).abs() < 0.01), "{color:?}");
        let degenerate = decode(&png_with(&[(b"cHRM", &numbers(&[0; 8]))]), "").unwrap();
        assert!(degenerate.warnings[0].contains("span no colour space"));
    }

    #[test]
    fn profiles_other_than_srgb_are_said() {
        for (name, expected) in [(&b"Adobe RGB (1998)"[..], 1), (b"sRGB IEC61966", 0)] {
            let mut colors = FileColors::default();
            colors.read_profile(name);
            assert_eq!(colors.warnings.len(), expected);
        }
    }

    #[test]
    fn associated_alpha_is_found_and_divided_out() {
        let mut tiff = b"II*\0\x08\0\0\0\x01\0".to_vec();
        tiff.extend_from_slice(&[0x52, 0x01, 3, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]);
        assert!(tiff_has_associated_alpha(&tiff));
        tiff[18] = 2;
        assert!(!tiff_has_associated_alpha(&tiff));
        for length in 0..tiff.len() {
            assert!(!tiff_has_associated_alpha(&tiff[..length]), "{length}");
        }
        let samples = Samples::U8(vec![100, 50, 25, 128, 9, 9, 9, 0]);
        let mut bitmap =
            Bitmap { width: 2, height: 1, channels: 4, samples, srgb: true, ..Bitmap::default() };
        divide_by_alpha(&mut bitmap);
        assert_eq!(bitmap.samples, Samples::U8(vec![199, 100, 50, 128, 9, 9, 9, 0]));
    }
}
