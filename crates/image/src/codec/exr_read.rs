//! Reads OpenEXR files with the `exr` crate: the first part, scan lines or tiles.

use std::io::Cursor;
use std::panic::catch_unwind;

use exr::image::{AnyChannels, FlatSamples, Image, Layer as ExrLayer};
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::meta::header::Header;
use exr::prelude::{Compression, ReadChannels, ReadLayers};
use half::f16;
use half::slice::HalfFloatSliceExt;

use super::exr_write::STRUCTURAL;
use crate::picture::find_main_layer;
use crate::{Bitmap, ImageError, Layer, Limits, MainLayer, MetadataValue, Picture};
use crate::{Samples, Window};

const FORMAT: &str = "OpenEXR";

/// Parts with fewer samples than this are unpacked on one thread: they take less time than starting
/// others.
const PARALLEL_SAMPLES: usize = 1 << 19;

/// A file's first part, with its own samples.
struct Part {
    header: Header,
    names: Vec<String>,
    channels: Vec<FlatSamples>,
    width: u32,
    height: u32,
}

/// Reads the main layer over the data window, in half precision if the file has it so.
pub(super) fn decode_bitmap(bytes: &[u8], limits: &Limits) -> Result<Bitmap, ImageError> {
    let part = read_part(bytes, limits)?;
    let names: Vec<&str> = part.names.iter().map(String::as_str).collect();
    let main = find_main_layer(&names).ok_or_else(|| {
        let message = format!("neither colour nor grey channels, but only: {}", names.join(", "));
        ImageError::unsupported(FORMAT, message)
    })?;
    let indices = channel_indices(&main);
    let selected: Vec<&FlatSamples> = indices.iter().map(|&index| &part.channels[index]).collect();
    let samples = interleave(&selected);
    let (width, height, channels) = (part.width, part.height, indices.len() as u32);
    Ok(Bitmap { width, height, channels, samples, srgb: false })
}

/// Reads all channels and all metadata.
pub(super) fn decode_picture(bytes: &[u8], limits: &Limits) -> Result<Picture, ImageError> {
    let part = read_part(bytes, limits)?;
    let mut picture = Picture::new(part.width, part.height);
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
    let named = part.names.into_iter().zip(part.channels);
    picture.channels =
        named.map(|(name, samples)| Layer { name, data: into_floats(samples) }).collect();
    Ok(picture)
}

/// Checks the header, then reads the first part's channels.
fn read_part(bytes: &[u8], limits: &Limits) -> Result<Part, ImageError> {
    let meta_data = guarded(|| MetaData::read_from_buffered(Cursor::new(bytes), false))?;
    check_headers(&meta_data.headers, bytes.len(), limits)?;
    let header = meta_data.headers.into_iter().next();
    let header = header.ok_or_else(|| ImageError::malformed(FORMAT, "no parts"))?;
    let width = dimension(header.layer_size.width())?;
    let height = dimension(header.layer_size.height())?;
    let is_small = width as usize * height as usize * header.channels.list.len() < PARALLEL_SAMPLES;

    let image: Image<ExrLayer<AnyChannels<FlatSamples>>> = guarded(|| {
        let reader = exr::image::read::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes();
        let reader = if is_small { reader.non_parallel() } else { reader };
        reader.from_buffered(Cursor::new(bytes))
    })?;
    let list = image.layer_data.channel_data.list;
    let expected = width as usize * height as usize;
    if list.is_empty() || list.iter().any(|channel| channel.sample_data.len() != expected) {
        return Err(ImageError::malformed(FORMAT, "channels without as many samples as pixels"));
    }
    let names = list.iter().map(|channel| text(&channel.name)).collect();
    let channels = list.into_iter().map(|channel| channel.sample_data).collect();
    Ok(Part { header, names, channels, width, height })
}

/// Calls into the `exr` crate. Its parser returns errors for the broken files we know, but it is
/// also full of `expect`: a panic there must not take the host down with it.
fn guarded<T>(
    read: impl FnOnce() -> exr::error::Result<T> + std::panic::UnwindSafe,
) -> Result<T, ImageError> {
    match catch_unwind(read) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(exr::error::Error::NotSupported(message))) => {
            Err(ImageError::unsupported(FORMAT, message.to_string()))
        }
        Ok(Err(error)) => Err(ImageError::malformed(FORMAT, error.to_string())),
        Err(_) => Err(ImageError::malformed(FORMAT, "the reader gave up on it")),
    }
}

/// Refuses what is not supported, and sizes that the file cannot hold.
fn check_headers(headers: &[Header], file_size: usize, limits: &Limits) -> Result<(), ImageError> {
    let unsupported = |message| Err(ImageError::unsupported(FORMAT, message));
    let mut table_bytes: u64 = 0;
    for header in headers {
        if header.deep {
            return unsupported("deep data");
        }
        table_bytes = table_bytes.saturating_add((header.chunk_count as u64).saturating_mul(8));
    }
    if table_bytes > file_size as u64 {
        return Err(ImageError::malformed(FORMAT, "fewer bytes than its table of chunks takes"));
    }
    let Some(header) = headers.first() else {
        return Err(ImageError::malformed(FORMAT, "no parts"));
    };
    if header.channels.list.iter().any(|c| c.sampling.x() != 1 || c.sampling.y() != 1) {
        return unsupported("subsampled channels (luminance and chroma)");
    }
    let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
    limits.check(width, height, header.channels.list.len() as u64, 4)?;
    let pixel_bytes: u64 =
        header.channels.list.iter().map(|c| c.sample_type.bytes_per_sample() as u64).sum();
    let claimed = width * height * pixel_bytes;
    if claimed > largest_expansion(header.compression).saturating_mul(file_size as u64) {
        let message = format!("{file_size} bytes cannot hold {width}x{height} pixels");
        return Err(ImageError::malformed(FORMAT, message));
    }
    Ok(())
}

/// Most bytes of samples that one byte of the file can become, rounded up.
fn largest_expansion(compression: Compression) -> u64 {
    match compression {
        Compression::Uncompressed => 1,
        // A run of 128 takes two bytes.
        Compression::RLE => 64,
        // Sixteen samples take three bytes.
        Compression::B44 | Compression::B44A => 16,
        // Deflate ends at 1032, a Huffman code for 255 samples below that. PXR24 leaves out a
        // quarter of each float.
        Compression::ZIP1 | Compression::ZIP16 | Compression::PIZ | Compression::PXR24 => 1400,
        // An empty block of 64 samples takes two bytes, which deflate again.
        _ => 1 << 17,
    }
}

fn dimension(size: usize) -> Result<u32, ImageError> {
    let size = u32::try_from(size).ok().filter(|&size| size > 0);
    size.ok_or_else(|| ImageError::malformed(FORMAT, "a window without pixels"))
}

/// The main layer's channels in the order of a [`Bitmap`].
fn channel_indices(main: &MainLayer) -> Vec<usize> {
    let color = if main.is_grey { &main.color[..1] } else { &main.color[..] };
    color.iter().copied().chain(main.alpha).collect()
}

/// Interleaves channels: as halves if all are, else as floats.
fn interleave(channels: &[&FlatSamples]) -> Samples {
    let halves: Option<Vec<&Vec<f16>>> = channels
        .iter()
        .map(|samples| if let FlatSamples::F16(values) = samples { Some(values) } else { None })
        .collect();
    if let Some(planes) = halves {
        return Samples::F16(interleave_planes(&planes));
    }
    let planes: Vec<Vec<f32>> =
        channels.iter().map(|&samples| into_floats(samples.clone())).collect();
    Samples::F32(interleave_planes(&planes.iter().collect::<Vec<_>>()))
}

fn interleave_planes<T: Copy>(planes: &[&Vec<T>]) -> Vec<T> {
    let count = planes.first().map_or(0, |plane| plane.len());
    (0..count).flat_map(|pixel| planes.iter().map(move |plane| plane[pixel])).collect()
}

fn into_floats(samples: FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F32(values) => values,
        FlatSamples::F16(values) => values.to_f32_vec(),
        FlatSamples::U32(values) => values.into_iter().map(|value| value as f32).collect(),
    }
}

/// The attributes that describe the picture, not the file, sorted by name. Types that
/// [`MetadataValue`] has no place for are left out.
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
        AttributeValue::Chromaticities(value) => {
            let [red, green, blue, white] = [value.red, value.green, value.blue, value.white];
            let points = [red, green, blue, white].map(|point| [point.x(), point.y()]);
            MetadataValue::Chromaticities([
                points[0][0],
                points[0][1],
                points[1][0],
                points[1][1],
                points[2][0],
                points[2][1],
                points[3][0],
                points[3][1],
            ])
        }
        _ => return None,
    })
}

fn text(text: &Text) -> String {
    String::from_utf8_lossy(text.bytes()).into_owned()
}
