//! Pictures from a buffer instead of a file.

use etendue_document::{Buffer, Elements, Fault, Parameters};
use etendue_image::{Bitmap, Samples};

/// Reads the picture from the parameter `data`, which replaces `filename`. Returns `None` after
/// reporting an error.
pub(crate) fn read(parameters: &Parameters<'_>) -> Option<Bitmap> {
    if parameters.has("filename") {
        let message = "a picture comes from `filename` or from `data`, not from both";
        parameters.error(Fault::BadValue, "filename", message);
        // Mark both as read, so that neither is reported as unknown.
        let _ = (parameters.value("filename"), parameters.value("data"));
        return None;
    }
    let report = |message: String| parameters.error(Fault::BadValue, "data", message);
    bitmap(parameters.buffer("data")?).map_err(report).ok()
}

/// Converts a buffer to texels: rows, columns and, if there are several, channels.
fn bitmap(buffer: &Buffer) -> Result<Bitmap, String> {
    let (height, width, channels) = match *buffer.shape() {
        [height, width] => (height, width, 1),
        [height, width, channels @ 1..=4] => (height, width, channels),
        ref other => {
            return Err(format!(
                "`data` has the shape {other:?}, but needs rows, columns and at most four channels"
            ));
        }
    };
    let side = |side: usize| u32::try_from(side).ok().filter(|side| *side > 0);
    let (Some(width), Some(height)) = (side(width), side(height)) else {
        return Err(format!("a picture of {width} × {height} texels cannot be shown"));
    };
    let samples = match buffer.elements() {
        Elements::U8(values) => Samples::U8(values.to_vec()),
        Elements::U16(values) => Samples::U16(values.to_vec()),
        Elements::F16(values) => Samples::F16(values.to_vec()),
        Elements::F32(values) => Samples::F32(values.to_vec()),
        Elements::F64(values) => Samples::F32(values.iter().map(|value| *value as f32).collect()),
        other => {
            let found = other.type_name();
            return Err(format!("`data` must hold floats, bytes or 16-bit integers, not {found}"));
        }
    };
    let srgb = matches!(samples, Samples::U8(_) | Samples::U16(_));
    Ok(Bitmap { width, height, channels: channels as u32, samples, srgb, ..Bitmap::default() })
}
