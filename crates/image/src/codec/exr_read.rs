//! Decodes OpenEXR files to bitmaps and pictures.

use exr::image::FlatSamples;
use exr::meta::attribute::{AttributeValue, Chromaticities, Text};
use exr::meta::header::Header;
use half::f16;
use half::slice::HalfFloatSliceExt;

use super::exr_part::{FORMAT, read_headers, read_part};
use super::exr_write::STRUCTURAL;
use crate::picture::{degenerate_chromaticities, find_main_layer};
use crate::primaries::to_bt709;
use crate::{Bitmap, Channel, ImageError, Limits, MainLayer, MetadataValue, Picture};
use crate::{Samples, Window};

/// Decodes the main layer over the data window, in half precision if the file has it.
pub(super) fn decode_bitmap(bytes: &[u8], limits: &Limits) -> Result<Bitmap, ImageError> {
    let part = read_part(bytes, limits)?;
    let names = channel_names(&part.header);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let main = find_main_layer(&names).ok_or_else(|| {
        let message = format!("neither colour nor grey channels, but only: {}", names.join(", "));
        ImageError::unsupported(FORMAT, message)
    })?;
    let indices = channel_indices(&main);
    let selected: Vec<&FlatSamples> = indices.iter().map(|&index| &part.channels[index]).collect();
    let mut warnings = part.warnings;
    let chromaticities = part.header.shared_attributes.chromaticities;
    let points = chromaticities.as_ref().map(points).filter(|_| !main.is_grey);
    let to_bt709 = points.and_then(|points| {
        to_bt709(&points).unwrap_or_else(|_| {
            warnings.push(degenerate_chromaticities(&points));
            None
        })
    });
    Ok(Bitmap {
        width: dimension(part.header.layer_size.width())?,
        height: dimension(part.header.layer_size.height())?,
        channels: indices.len() as u32,
        samples: interleave(&selected),
        srgb: false,
        to_bt709,
        warnings,
    })
}

/// Decodes all channels and all metadata.
pub(super) fn decode_picture(bytes: &[u8], limits: &Limits) -> Result<Picture, ImageError> {
    let part = read_part(bytes, limits)?;
    let size = part.header.layer_size;
    let mut picture = Picture::new(dimension(size.width())?, dimension(size.height())?);
    let position = part.header.own_attributes.layer_position;
    picture.data_origin = [position.x(), position.y()];
    let display = part.header.shared_attributes.display_window;
    picture.display_window = Window {
        x: display.position.x(),
        y: display.position.y(),
        width: dimension(display.size.width())?,
        height: dimension(display.size.height())?,
    };
    picture.metadata = metadata(&part.header);
    picture.warnings = part.warnings;
    let named = channel_names(&part.header).into_iter().zip(part.channels);
    picture.channels =
        named.map(|(name, samples)| Channel { name, data: into_floats(samples) }).collect();
    Ok(picture)
}

/// The metadata of the first part; empty if the header is not valid.
pub(super) fn metadata_of_file(bytes: &[u8]) -> Vec<(String, MetadataValue)> {
    let headers = read_headers(bytes).unwrap_or_default();
    headers.first().map_or_else(Vec::new, metadata)
}

fn channel_names(header: &Header) -> Vec<String> {
    header.channels.list.iter().map(|channel| text(&channel.name)).collect()
}

fn dimension(size: usize) -> Result<u32, ImageError> {
    let size = u32::try_from(size).ok().filter(|&size| size > 0);
    size.ok_or_else(|| ImageError::malformed(FORMAT, "a window without pixels"))
}

/// The channels of the main layer in the order of a [`Bitmap`].
fn channel_indices(main: &MainLayer) -> Vec<usize> {
    let color = if main.is_grey { &main.color[..1] } else { &main.color[..] };
    color.iter().copied().chain(main.alpha).collect()
}

/// Interleaves channels: as halves if all are halves, else as floats.
fn interleave(channels: &[&FlatSamples]) -> Samples {
    let halves: Option<Vec<&[f16]>> = channels
        .iter()
        .map(
            |samples| if let FlatSamples::F16(values) = samples { Some(&values[..]) } else { None },
        )
        .collect();
    if let Some(planes) = halves {
        return Samples::F16(interleave_planes(&planes));
    }
    let planes: Vec<Vec<f32>> =
        channels.iter().map(|&samples| into_floats(samples.clone())).collect();
    Samples::F32(interleave_planes(&planes.iter().map(Vec::as_slice).collect::<Vec<_>>()))
}

fn interleave_planes<T: Copy>(planes: &[&[T]]) -> Vec<T> {
    let count = planes.first().map_or(0, |plane| plane.len());
    let mut samples = Vec::with_capacity(count * planes.len());
    for pixel in 0..count {
        samples.extend(planes.iter().map(|plane| plane[pixel]));
    }
    samples
}

pub(super) fn into_floats(samples: FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F32(values) => values,
        FlatSamples::F16(values) => values.to_f32_vec(),
        FlatSamples::U32(values) => values.into_iter().map(|value| value as f32).collect(),
    }
}

/// The attributes that describe the picture rather than the file, sorted by name. Types without a
/// [`MetadataValue`] are ignored.
fn metadata(header: &Header) -> Vec<(String, MetadataValue)> {
    let mut found: Vec<(String, MetadataValue)> = header
        .all_named_attributes()
        .map(|(name, value)| (String::from_utf8_lossy(name).into_owned(), value))
        .filter(|(name, _)| !STRUCTURAL.contains(&name.as_str()))
        .filter_map(|(name, value)| Some((name, metadata_value(&value)?)))
        .collect();
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

fn metadata_value(value: &AttributeValue) -> Option<MetadataValue> {
    Some(match value {
        AttributeValue::Text(value) => MetadataValue::Text(text(value)),
        AttributeValue::I32(value) => MetadataValue::Integer(*value),
        AttributeValue::F32(value) => MetadataValue::Float(*value),
        AttributeValue::F64(value) => MetadataValue::Double(*value),
        AttributeValue::FloatVec2(value) => MetadataValue::Vector2([value.x(), value.y()]),
        AttributeValue::FloatVec3((x, y, z)) => MetadataValue::Vector3([*x, *y, *z]),
        AttributeValue::Matrix3x3(value) => MetadataValue::Matrix3(*value),
        AttributeValue::Matrix4x4(value) => MetadataValue::Matrix4(*value),
        AttributeValue::Chromaticities(value) => MetadataValue::Chromaticities(points(value)),
        _ => return None,
    })
}

/// x and y of red, green, blue and white.
pub(super) fn points(value: &Chromaticities) -> [f32; 8] {
    let (red, green, blue, white) = (value.red, value.green, value.blue, value.white);
    [red.0, red.1, green.0, green.1, blue.0, blue.1, white.0, white.1]
}

fn text(text: &Text) -> String {
    String::from_utf8_lossy(text.bytes()).into_owned()
}
