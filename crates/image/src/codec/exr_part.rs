//! The first part of an OpenEXR file: its header, and the samples of its channels.
//!
//! Chunks are decompressed here rather than by the `exr` crate's own image reader, which uses a
//! thread pool where a panic aborts the process.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use exr::block::UncompressedBlock;
use exr::block::chunk::Chunk;
use exr::image::FlatSamples;
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::prelude::Compression;
use half::f16;
use rayon::prelude::*;

use super::exr_chroma::{Sampled, convert_to_rgb};
use crate::{ImageError, Limits, PictureHeader};

/// The format's name in messages.
pub(super) const FORMAT: &str = "OpenEXR";

/// Parts with fewer samples are decompressed on one thread.
const PARALLEL_SAMPLES: usize = 1 << 17;

/// The number of chunks that are decompressed before their samples are stored.
const CHUNK_BATCH: usize = 64;

/// The first part of a file.
pub(super) struct Part {
    pub(super) header: Header,
    /// Samples of the whole data window, for each channel of the header.
    pub(super) channels: Vec<FlatSamples>,
    /// How the channels differ from those of the file, for people.
    pub(super) warnings: Vec<String>,
}

/// Checks the headers, then reads the channels of the first part at full resolution.
pub(super) fn read_part(bytes: &[u8], limits: &Limits) -> Result<Part, ImageError> {
    let part = match Sampled::find(bytes) {
        Some(sampled) => sampled.read_part(limits)?,
        None => read_full(bytes, limits)?,
    };
    Ok(convert_to_rgb(part))
}

/// Reads channels that have a sample for each pixel.
fn read_full(bytes: &[u8], limits: &Limits) -> Result<Part, ImageError> {
    let reader = guarded(|| exr::block::read(Cursor::new(bytes), false))?;
    let first = check_headers(reader.headers(), bytes.len(), limits, &[])?.clone();
    let channels = guarded(|| {
        let mut channels = allocate(&first);
        let meta_data = reader.meta_data().clone();
        let mut chunks = reader.filter_chunks(false, |_, tile, block| {
            block.layer == 0 && tile.level_index == Vec2(0, 0)
        })?;
        let is_small = first.layer_size.area() * channels.len() < PARALLEL_SAMPLES;
        loop {
            let batch: Vec<Chunk> = chunks.by_ref().take(CHUNK_BATCH).collect::<Result<_, _>>()?;
            if batch.is_empty() {
                return Ok(channels);
            }
            for block in decompress(batch, &meta_data, is_small)? {
                store(&block, &first, &mut channels)?;
            }
        }
    })?;
    Ok(Part { header: first, channels, warnings: Vec::new() })
}

/// The headers of all parts. The file may end after them.
pub(super) fn read_headers(bytes: &[u8]) -> Result<Vec<Header>, ImageError> {
    let meta_data = guarded(|| MetaData::read_from_buffered(Cursor::new(bytes), false))?;
    Ok(meta_data.headers.into_vec())
}

/// The size that the header of the first part announces.
pub(super) fn read_header(bytes: &[u8], limits: &Limits) -> Result<PictureHeader, ImageError> {
    let sampled = Sampled::find(bytes);
    let (bytes, sampling) = match &sampled {
        Some(sampled) => sampled.with_full_sampling(),
        None => (bytes, &[][..]),
    };
    let headers = read_headers(bytes)?;
    let header = check_headers(&headers, bytes.len(), limits, sampling)?;
    let Vec2(width, height) = header.layer_size;
    let samples = (width as u64 * height as u64).saturating_mul(header.channels.list.len() as u64);
    let decoded_bytes = samples.saturating_mul(size_of::<f32>() as u64);
    Ok(PictureHeader {
        // The check has found that they fit.
        width: width as u32,
        height: height as u32,
        decoded_bytes,
        // Planes first, which are then interleaved.
        decoding_bytes: decoded_bytes.saturating_mul(2),
    })
}

/// Calls the `exr` crate, and turns panics into errors: its checks are incomplete, and some
/// malformed files fail its assertions or index out of bounds.
pub(super) fn guarded<T>(read: impl FnOnce() -> exr::error::Result<T>) -> Result<T, ImageError> {
    // Nothing that `read` has modified is used after a panic.
    match catch_unwind(AssertUnwindSafe(read)) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(exr::error::Error::NotSupported(message))) => {
            Err(ImageError::unsupported(FORMAT, message.to_string()))
        }
        Ok(Err(error)) => Err(ImageError::malformed(FORMAT, error.to_string())),
        Err(_) => Err(ImageError::malformed(FORMAT, "the sample blocks are inconsistent")),
    }
}

/// Rejects unsupported features, and sizes that the file cannot hold. Returns the first header.
/// `sampling` has the distances of its channels' samples, if they are not one.
pub(super) fn check_headers<'a>(
    headers: &'a [Header],
    file_size: usize,
    limits: &Limits,
    sampling: &[Vec2<usize>],
) -> Result<&'a Header, ImageError> {
    let malformed = |message: &str| ImageError::malformed(FORMAT, message);
    let mut table_bytes: u64 = 0;
    for header in headers {
        if header.deep {
            return Err(ImageError::unsupported(FORMAT, "deep data"));
        }
        table_bytes = table_bytes.saturating_add((header.chunk_count as u64).saturating_mul(8));
    }
    if table_bytes > file_size as u64 {
        return Err(malformed("it is shorter than its own table of chunks"));
    }
    let header = headers.first().ok_or_else(|| malformed("it has no parts"))?;
    let list = &header.channels.list;
    let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
    if list.is_empty() || width == 0 || height == 0 {
        return Err(malformed("it has no samples"));
    }
    limits.check(width, height, list.len() as u64, 4)?;
    let distances = sampling.iter().copied().chain(std::iter::repeat(Vec2(1, 1)));
    let channel_bytes = list.iter().zip(distances).map(|(channel, distance)| {
        let samples = (width / distance.x().max(1) as u64) * (height / distance.y().max(1) as u64);
        samples * channel.sample_type.bytes_per_sample() as u64
    });
    let possible = max_expansion(header.compression).saturating_mul(file_size as u64);
    if channel_bytes.sum::<u64>() > possible {
        let message = format!("{file_size} bytes cannot hold {width}x{height} pixels");
        return Err(malformed(&message));
    }
    Ok(header)
}

/// An upper bound of the sample bytes that one byte of the file can expand to.
fn max_expansion(compression: Compression) -> u64 {
    match compression {
        Compression::Uncompressed => 1,
        // A run of 128 takes two bytes.
        Compression::RLE => 64,
        // Sixteen samples take three bytes.
        Compression::B44 | Compression::B44A => 16,
        // Deflate reaches a factor of 1032; a Huffman code for 255 samples less. PXR24 drops a
        // quarter of each float.
        Compression::ZIP1 | Compression::ZIP16 | Compression::PIZ | Compression::PXR24 => 1400,
        // An empty block of 64 samples takes two bytes, which are deflated again.
        _ => 1 << 17,
    }
}

/// Zeroed samples for all channels.
fn allocate(header: &Header) -> Vec<FlatSamples> {
    let count = header.layer_size.area();
    let zeros = |sample_type| match sample_type {
        SampleType::F16 => FlatSamples::F16(vec![f16::ZERO; count]),
        SampleType::F32 => FlatSamples::F32(vec![0.0; count]),
        SampleType::U32 => FlatSamples::U32(vec![0; count]),
    };
    header.channels.list.iter().map(|channel| zeros(channel.sample_type)).collect()
}

/// Decompresses chunks.
fn decompress(
    chunks: Vec<Chunk>,
    meta_data: &MetaData,
    is_small: bool,
) -> exr::error::Result<Vec<UncompressedBlock>> {
    let decompress_one = |chunk| UncompressedBlock::decompress_chunk(chunk, meta_data, false);
    if is_small {
        chunks.into_iter().map(decompress_one).collect()
    } else {
        chunks.into_par_iter().map(decompress_one).collect()
    }
}

/// Copies the rows of a block to the channels. The position of a block is read from the chunk, so it
/// may be invalid.
fn store(
    block: &UncompressedBlock,
    header: &Header,
    channels: &mut [FlatSamples],
) -> exr::error::Result<()> {
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let (position, size) = (block.index.pixel_position, block.index.pixel_size);
    let is_within = |start: usize, length: usize, end: usize| {
        start.checked_add(length).is_some_and(|block_end| block_end <= end)
    };
    let expected_bytes = size.area() * header.channels.bytes_per_pixel;
    if block.index.layer != 0
        || block.index.level != Vec2(0, 0)
        || !is_within(position.x(), size.width(), width)
        || !is_within(position.y(), size.height(), height)
        || block.data.len() != expected_bytes
    {
        return Err(exr::error::Error::Invalid("a block outside of the image".into()));
    }
    for line in block.lines(&header.channels) {
        let start = line.location.position.y() * width + line.location.position.x();
        let range = start..start + line.location.sample_count;
        match &mut channels[line.location.channel] {
            FlatSamples::F16(samples) => line.read_samples_into_slice(&mut samples[range])?,
            FlatSamples::F32(samples) => line.read_samples_into_slice(&mut samples[range])?,
            FlatSamples::U32(samples) => line.read_samples_into_slice(&mut samples[range])?,
        }
    }
    Ok(())
}
