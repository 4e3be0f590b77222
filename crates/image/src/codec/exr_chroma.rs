//! OpenEXR files whose channels have fewer samples than pixels: luminance and chroma.
//!
//! The `exr` crate refuses such channels when it checks a header. Its decompressors know them, so the
//! header is read with a sampling of one, and the blocks are decompressed with the true one.

use std::io::Cursor;

use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
use exr::image::FlatSamples;
use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::{ChannelList, IntegerBounds, SampleType, Text};
use exr::meta::header::Header;
use exr::prelude::Compression;
use half::f16;

use super::exr_part::{FORMAT, Part, check_headers, guarded};
use crate::primaries::{BT709, luminance_weights};
use crate::{ImageError, Limits};

/// The channels of luminance and chroma, as the format sorts them.
const NAMES: [&str; 3] = ["BY", "RY", "Y"];

/// What is said of files whose luminance and chroma were converted.
const WARNING: &str = "its luminance and chroma become red, green and blue, with the chroma \
                       interpolated between its samples";

/// The parts of a file that describe its sampling.
pub(super) struct Sampled {
    /// The file with a sampling of one in its header.
    bytes: Vec<u8>,
    /// For each channel of the first part, the distance of its samples in x and y.
    sampling: Vec<Vec2<usize>>,
}

impl Sampled {
    /// `None` unless a channel of the first part has fewer samples than pixels.
    pub(super) fn find(file: &[u8]) -> Option<Self> {
        let mut at = find_channels(file)?;
        let (mut bytes, mut sampling) = (file.to_vec(), Vec::new());
        while *file.get(at)? != 0 {
            // Name, sample type, four bytes of flags.
            at += text_length(file, at)? + 8;
            let distance = |at: usize| usize::try_from(number(file, at)?).ok();
            sampling.push(Vec2(distance(at)?, distance(at + 4)?));
            for axis in [at, at + 4] {
                bytes.get_mut(axis..axis + 4)?.copy_from_slice(&1_i32.to_le_bytes());
            }
            at += 8;
        }
        sampling.iter().any(|distance| *distance != Vec2(1, 1)).then_some(Self { bytes, sampling })
    }

    /// The file with a sampling of one in its header, and the true sampling of each channel.
    pub(super) fn with_full_sampling(&self) -> (&[u8], &[Vec2<usize>]) {
        (&self.bytes, &self.sampling)
    }

    /// Reads the channels of the first part, interpolated to full resolution.
    pub(super) fn read_part(&self, limits: &Limits) -> Result<Part, ImageError> {
        let reader = guarded(|| exr::block::read(Cursor::new(&self.bytes), false))?;
        let file_size = self.bytes.len();
        let header = check_headers(reader.headers(), file_size, limits, &self.sampling)?.clone();
        self.check(&header)?;
        let mut planes = Planes::new(&header, &self.sampling);
        let chunks = guarded(|| {
            let chunks = reader.filter_chunks(false, |_, _, block| block.layer == 0)?;
            chunks.collect::<exr::error::Result<Vec<Chunk>>>()
        })?;
        for chunk in chunks {
            let CompressedBlock::ScanLine(block) = chunk.compressed_block else {
                return Err(ImageError::unsupported(FORMAT, "subsampled channels in tiles"));
            };
            planes.store(block)?;
        }
        let channels = planes.interpolated();
        Ok(Part { header, channels, warnings: Vec::new() })
    }

    /// Rejects what the decompressors cannot do, and distances that do not divide the window.
    fn check(&self, header: &Header) -> Result<(), ImageError> {
        use Compression::{PIZ, RLE, Uncompressed, ZIP1, ZIP16};
        let is_known = matches!(header.compression, Uncompressed | RLE | ZIP1 | ZIP16 | PIZ);
        if !is_known || header.blocks != BlockDescription::ScanLines {
            let message = "subsampled channels in tiles or with a lossy compression";
            return Err(ImageError::unsupported(FORMAT, message));
        }
        if header.channels.list.iter().any(|channel| channel.sample_type == SampleType::U32) {
            return Err(ImageError::unsupported(FORMAT, "subsampled channels of integers"));
        }
        let Vec2(x, y) = header.own_attributes.layer_position;
        let divides = |distance: usize, size: usize, start: i32| {
            i32::try_from(distance).is_ok_and(|d| d > 0 && start % d == 0)
                && size.is_multiple_of(distance)
        };
        let is_valid = |distance: &Vec2<usize>| {
            divides(distance.x(), header.layer_size.width(), x)
                && divides(distance.y(), header.layer_size.height(), y)
        };
        if self.sampling.len() == header.channels.list.len() && self.sampling.iter().all(is_valid) {
            Ok(())
        } else {
            Err(ImageError::malformed(FORMAT, "the sampling of a channel is not valid"))
        }
    }
}

/// The samples of each channel, before they are interpolated.
struct Planes<'a> {
    header: &'a Header,
    /// The channels with their true sampling.
    channels: ChannelList,
    planes: Vec<Vec<f32>>,
}

impl<'a> Planes<'a> {
    fn new(header: &'a Header, sampling: &[Vec2<usize>]) -> Self {
        let mut channels = header.channels.clone();
        for (channel, distance) in channels.list.iter_mut().zip(sampling) {
            channel.sampling = *distance;
        }
        let size = header.layer_size;
        let planes = channels.list.iter().map(|channel| {
            let Vec2(width, height) = channel.subsampled_resolution(size);
            vec![0.0; width * height]
        });
        Self { header, planes: planes.collect(), channels }
    }

    /// Decompresses a block and stores its rows.
    fn store(&mut self, block: CompressedScanLineBlock) -> Result<(), ImageError> {
        let malformed = || ImageError::malformed(FORMAT, "a block outside of the image");
        let size = self.header.layer_size;
        let top = self.header.own_attributes.layer_position.y();
        let rows_per_block = self.header.compression.scan_lines_per_block();
        let first = i64::from(block.y_coordinate) - i64::from(top);
        let first = usize::try_from(first).map_err(|_| malformed())?;
        if first >= size.height() || !first.is_multiple_of(rows_per_block) {
            return Err(malformed());
        }
        let rows = rows_per_block.min(size.height() - first);
        let section = IntegerBounds {
            position: Vec2(self.header.own_attributes.layer_position.x(), block.y_coordinate),
            size: Vec2(size.width(), rows),
        };
        let lengths: Vec<_> = (first..first + rows).map(|row| self.row_bytes(row)).collect();
        let length: usize = lengths.iter().sum();
        // The decompressors compute the length from the bytes per pixel.
        let pixels = size.width() * rows;
        if !length.is_multiple_of(pixels) {
            return Err(ImageError::unsupported(FORMAT, "this sampling of channels"));
        }
        let mut header = self.header.clone();
        header.channels = ChannelList { bytes_per_pixel: length / pixels, ..self.channels.clone() };
        let bytes = guarded(|| {
            header.compression.decompress_image_section_from_le(
                &header,
                block.compressed_pixels_le,
                section,
                false,
            )
        })?;
        if bytes.len() != length {
            return Err(ImageError::malformed(FORMAT, "a block has too many or too few samples"));
        }
        let mut rest = bytes.as_slice();
        for row in first..first + rows {
            for (channel, plane) in self.channels.list.iter().zip(&mut self.planes) {
                if !row.is_multiple_of(channel.sampling.y()) {
                    continue;
                }
                let width = size.width() / channel.sampling.x();
                let (line, after) = rest.split_at(width * channel.sample_type.bytes_per_sample());
                rest = after;
                let start = row / channel.sampling.y() * width;
                read_line(line, channel.sample_type, &mut plane[start..start + width]);
            }
        }
        Ok(())
    }

    /// The bytes of all samples of a row, which is counted from the top of the window.
    fn row_bytes(&self, row: usize) -> usize {
        let channels = self.channels.list.iter();
        let present = channels.filter(|channel| row.is_multiple_of(channel.sampling.y()));
        present
            .map(|channel| {
                let width = self.header.layer_size.width() / channel.sampling.x();
                width * channel.sample_type.bytes_per_sample()
            })
            .sum()
    }

    /// All channels at full resolution, linear between their samples.
    fn interpolated(self) -> Vec<FlatSamples> {
        let size = self.header.layer_size;
        let interpolate = |(plane, distance): (Vec<f32>, Vec2<usize>)| {
            if distance == Vec2(1, 1) {
                return plane;
            }
            let Vec2(width, height) = Vec2(size.x() / distance.x(), size.y() / distance.y());
            let mut values = Vec::with_capacity(size.area());
            for y in 0..size.height() {
                let (upper, lower, down) = neighbours(y, distance.y(), height);
                for x in 0..size.width() {
                    let (left, right, across) = neighbours(x, distance.x(), width);
                    let line = |row: usize| {
                        let row = &plane[row * width..(row + 1) * width];
                        row[left] + (row[right] - row[left]) * across
                    };
                    values.push(line(upper) + (line(lower) - line(upper)) * down);
                }
            }
            values
        };
        let distances = self.channels.list.iter().map(|channel| channel.sampling);
        let pairs = self.planes.into_iter().zip(distances);
        pairs.map(|pair| FlatSamples::F32(interpolate(pair))).collect()
    }
}

/// The samples on either side of a pixel, and the weight of the second.
fn neighbours(pixel: usize, distance: usize, count: usize) -> (usize, usize, f32) {
    let low = pixel / distance;
    (low, (low + 1).min(count - 1), (pixel % distance) as f32 / distance as f32)
}

fn read_line(line: &[u8], sample_type: SampleType, values: &mut [f32]) {
    match sample_type {
        SampleType::F16 => {
            for (value, bytes) in values.iter_mut().zip(line.as_chunks().0) {
                *value = f16::from_ne_bytes(*bytes).to_f32();
            }
        }
        SampleType::F32 | SampleType::U32 => {
            for (value, bytes) in values.iter_mut().zip(line.as_chunks().0) {
                *value = f32::from_ne_bytes(*bytes);
            }
        }
    }
}

/// Turns the channels `Y`, `RY` and `BY`, if there are all three, into `G`, `R` and `B`: RY is
/// R / Y - 1, BY is B / Y - 1, and Y is the luminance of the file's primaries.
pub(super) fn convert_to_rgb(mut part: Part) -> Part {
    let place =
        |name: &str| part.header.channels.list.iter().position(|channel| channel.name.eq(name));
    let [Some(blue), Some(red), Some(luminance)] = NAMES.map(place) else {
        return part;
    };
    let chromaticities = part.header.shared_attributes.chromaticities;
    let points = chromaticities.as_ref().map_or(BT709, super::exr_read::points);
    let weights = luminance_weights(&points);
    let mut planes = [red, luminance, blue].map(|index| {
        super::exr_read::into_floats(std::mem::replace(
            &mut part.channels[index],
            FlatSamples::F32(Vec::new()),
        ))
    });
    let [reds, greens, blues] = &mut planes;
    for ((red, green), blue) in reds.iter_mut().zip(greens).zip(blues) {
        let luminance = *green;
        *red = (*red + 1.0) * luminance;
        *blue = (*blue + 1.0) * luminance;
        *green = (luminance - weights[0] * *red - weights[2] * *blue) / weights[1];
    }
    for ((index, name), plane) in
        [(red, "R"), (luminance, "G"), (blue, "B")].into_iter().zip(planes)
    {
        part.header.channels.list[index].name = Text::from(name);
        part.channels[index] = FlatSamples::F32(plane);
    }
    part.warnings.push(WARNING.to_owned());
    part
}

/// The place of the first channel in the header of the first part.
fn find_channels(file: &[u8]) -> Option<usize> {
    /// Magic number and version.
    const START: usize = 8;
    let mut at = START;
    while *file.get(at)? != 0 {
        let name_length = text_length(file, at)?;
        let kind = at + name_length;
        let size = kind + text_length(file, kind)?;
        if file.get(at..at + name_length)? == b"channels\0" {
            return Some(size + 4);
        }
        at = (size + 4).checked_add(usize::try_from(number(file, size)?).ok()?)?;
    }
    None
}

/// The length of a text with the zero that ends it.
fn text_length(file: &[u8], at: usize) -> Option<usize> {
    Some(file.get(at..)?.iter().position(|byte| *byte == 0)? + 1)
}

fn number(file: &[u8], at: usize) -> Option<i32> {
    file.get(at..)?.first_chunk().map(|bytes| i32::from_le_bytes(*bytes))
}
