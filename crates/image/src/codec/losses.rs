//! Values that a file format cannot hold.

use super::options::{EncodeOptions, ExrPrecision};
use crate::{FileFormat, MainLayer, Picture};

/// The greatest value of Radiance HDR: the mantissa 255 with the exponent 255.
pub(super) const GREATEST_HDR: f32 = f32::from_bits((127 + 126) << 23 | 0x7f_0000);

/// Colours below this have no exponent in Radiance HDR, and become black.
pub(super) const LEAST_HDR: f32 = f32::from_bits(1 << 21);

/// The greatest half float.
const GREATEST_HALF: f32 = 65504.0;

/// What a file of this format does not say of a picture, in clauses for people, such as `3 values
/// are not numbers and become 0`. Rounding, and the range of a display, are not mentioned.
pub fn losses(picture: &Picture, format: FileFormat, options: &EncodeOptions) -> Vec<String> {
    match format {
        FileFormat::Pfm | FileFormat::Npy | FileFormat::Npz => Vec::new(),
        FileFormat::Exr if options.exr_precision == ExrPrecision::Float => Vec::new(),
        FileFormat::Exr => {
            let values = picture.channels.iter().flat_map(|channel| &channel.data);
            let count = values.filter(|v| v.is_finite() && v.abs() > GREATEST_HALF).count();
            clause(count, "is too large and becomes", "are too large and become", "65504")
        }
        FileFormat::Hdr => counted(picture, GREATEST_HDR, "1.6947e38"),
        FileFormat::Png | FileFormat::Jpeg | FileFormat::Bmp | FileFormat::Tiff => {
            counted(picture, f32::MAX, "white")
        }
    }
}

/// The values of the main layer that are no numbers, above `greatest`, or negative.
fn counted(picture: &Picture, greatest: f32, greatest_name: &str) -> Vec<String> {
    let Some(MainLayer { color, is_grey, .. }) = picture.main_layer() else {
        return Vec::new();
    };
    let distinct = if is_grey { &color[..1] } else { &color[..] };
    let count = |is_lost: &dyn Fn(f32) -> bool| -> usize {
        let data = distinct.iter().map(|index| &picture.channels[*index].data);
        data.map(|data| data.iter().filter(|value| is_lost(**value)).count()).sum()
    };
    let mut clauses = Vec::new();
    let nan = count(&f32::is_nan);
    clauses.extend(clause(nan, "is not a number and becomes", "are not numbers and become", "0"));
    let above = count(&|value| value > greatest);
    clauses.extend(clause(
        above,
        "is too large and becomes",
        "are too large and become",
        greatest_name,
    ));
    let negative = count(&|value| value < 0.0);
    clauses.extend(clause(negative, "is negative and becomes", "are negative and become", "0"));
    clauses
}

/// `3 values` and what happens to them; nothing if there are none.
fn clause(count: usize, singular: &str, plural: &str, result: &str) -> Vec<String> {
    match count {
        0 => Vec::new(),
        1 => vec![format!("1 value {singular} {result}")],
        _ => vec![format!("{count} values {plural} {result}")],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{decode, encode};

    /// Three pixels whose colours are the values.
    fn grey(values: &[f32]) -> Picture {
        let mut picture = Picture::new(values.len() as u32, 1);
        for name in ["R", "G", "B"] {
            picture.push(name, values.to_vec());
        }
        picture
    }

    #[test]
    fn hdr_holds_its_greatest_value_for_infinity_and_zero_for_what_has_no_exponent() {
        let picture = grey(&[f32::INFINITY, f32::MAX, f32::NAN, -1.0, 1e-40, 2.0]);
        let options = EncodeOptions::default();
        let bytes = encode(&picture, FileFormat::Hdr, &options).unwrap();
        let read: Vec<f32> =
            decode(&bytes, "").unwrap().to_color_image().pixels.iter().map(|p| p[0]).collect();
        assert_eq!(read, [GREATEST_HDR, GREATEST_HDR, 0.0, 0.0, 0.0, 2.0]);
        assert_eq!(GREATEST_HDR, 255.0 * 2.0_f32.powi(119));
        let said = losses(&picture, FileFormat::Hdr, &options);
        assert_eq!(
            said,
            [
                "3 values are not numbers and become 0",
                "6 values are too large and become 1.6947e38",
                "3 values are negative and become 0"
            ]
        );
    }

    #[test]
    fn display_formats_show_infinity_as_white_and_say_so() {
        let picture = grey(&[f32::INFINITY, f32::NAN, -1.0, 2.0]);
        let options = EncodeOptions::default();
        for format in FileFormat::all().filter(|format| !format.is_linear()) {
            assert_eq!(losses(&picture, format, &options).len(), 3, "{format:?}");
            assert!(losses(&grey(&[0.0, 2.0]), format, &options).is_empty());
        }
        let bytes = encode(&picture, FileFormat::Png, &options).unwrap();
        let read = decode(&bytes, "").unwrap().to_raw();
        assert_eq!(read, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    }

    #[test]
    fn halves_say_what_they_clip_and_floats_keep_everything() {
        let picture = grey(&[1e30]);
        let mut options = EncodeOptions::default();
        assert!(losses(&picture, FileFormat::Exr, &options).is_empty());
        options.exr_precision = ExrPrecision::Half;
        let said = losses(&picture, FileFormat::Exr, &options);
        assert_eq!(said, ["3 values are too large and become 65504"]);
    }
}
