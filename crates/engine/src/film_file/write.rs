//! From sums to bytes.

use std::io::{self, Write};

use super::bytes::{HashingWriter, push_length, push_text};
use super::format::{FilmRecord, MAGIC, VERSION};
use crate::exact_sums::ExactSums;
use crate::film_sums::FilmSums;
use crate::splats::Splats;
use crate::statistics::{Defect, DefectiveSample, Defects};
use crate::tile::Tile;
use etendue_integrators::ChannelKind;

impl FilmSums {
    /// Writes the sums, tile by tile. Other threads may add to the film meanwhile.
    ///
    /// # Errors
    ///
    /// The error of `out`.
    pub fn write(&self, record: &FilmRecord, out: &mut dyn Write) -> io::Result<()> {
        let header = self.header(record);
        let mut out = HashingWriter { inner: out, hasher: blake3::Hasher::new() };
        out.write(MAGIC)?;
        out.write(&VERSION.to_le_bytes())?;
        let mut length = Vec::new();
        push_length(&mut length, header.len());
        out.write(&length)?;
        out.write(&header)?;
        // A splat may land anywhere, so the splats and counts agree only while no tile has a turn.
        let _pause = self.splats().map(Splats::pause);
        let mut bytes = Vec::new();
        for index in 0..self.tile_count() {
            bytes.clear();
            // The lock is held while the tile is copied, but not while it is written.
            push_tile(&mut bytes, &self.tile(index));
            out.write(&bytes)?;
        }
        for row in self.splats().into_iter().flat_map(Splats::rows) {
            bytes.clear();
            push_sums(&mut bytes, &row);
            out.write(&bytes)?;
        }
        let checksum = out.hasher.finalize();
        out.inner.write_all(checksum.as_bytes())
    }

    fn header(&self, record: &FilmRecord) -> Vec<u8> {
        let mut bytes = Vec::new();
        for pairs in [&record.identity, &record.notes] {
            push_length(&mut bytes, pairs.len());
            for (name, value) in pairs {
                push_text(&mut bytes, name);
                push_text(&mut bytes, value);
            }
        }
        bytes.extend_from_slice(&record.planned_samples.to_le_bytes());
        bytes.extend_from_slice(&record.seconds.to_le_bytes());
        let region = self.region();
        for number in [
            region.x,
            region.y,
            region.width,
            region.height,
            self.first_sample(),
            self.samples_per_pixel().least,
            self.tile_side(),
        ] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        bytes.push(u8::from(self.has_variance()));
        bytes.push(u8::from(self.splats().is_some()));
        push_length(&mut bytes, self.channel_names().len());
        for name in self.channel_names() {
            push_text(&mut bytes, name);
        }
        push_length(&mut bytes, self.channel_kinds().len());
        bytes.extend(self.channel_kinds().iter().map(|kind| match kind {
            ChannelKind::Mean => 0,
            ChannelKind::Nearest => 1,
        }));
        bytes
    }
}

fn push_tile(bytes: &mut Vec<u8>, tile: &Tile) {
    bytes.extend_from_slice(&tile.next_sample.to_le_bytes());
    push_defects(bytes, &tile.defects);
    for count in tile.counts.iter().chain(&tile.odd_counts) {
        bytes.extend_from_slice(&count.to_le_bytes());
    }
    push_sums(bytes, &tile.sums);
    push_sums(bytes, &tile.odd_sums);
    if !tile.nearest.is_empty() {
        for pixel in 0..tile.counts.len() {
            let (key, values) = tile.nearest.pixel(pixel);
            bytes.extend(key.raw().iter().flat_map(|number| number.to_le_bytes()));
            bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        }
    }
}

fn push_defects(bytes: &mut Vec<u8>, defects: &Defects) {
    bytes.extend_from_slice(&defects.non_finite.to_le_bytes());
    bytes.extend_from_slice(&defects.negative.to_le_bytes());
    push_length(bytes, defects.first.len());
    for DefectiveSample { id, defect } in &defects.first {
        for number in [id.index, id.y, id.x] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        bytes.push(match defect {
            Defect::NonFinite => 0,
            Defect::Negative => 1,
        });
    }
}

/// Appends sums. They are most of a file, so the vector grows once for all of them.
fn push_sums(bytes: &mut Vec<u8>, sums: &ExactSums) {
    let (limits, digits) = sums.raw_parts();
    for (place, limit) in grow(bytes, limits.len() * 2).chunks_exact_mut(2).zip(limits) {
        place.copy_from_slice(&limit.to_le_bytes());
    }
    for (place, [high, low]) in grow(bytes, digits.len() * 16).chunks_exact_mut(16).zip(digits) {
        place[..8].copy_from_slice(&high.to_le_bytes());
        place[8..].copy_from_slice(&low.to_le_bytes());
    }
}

/// Appends zeros, and returns them to be overwritten.
fn grow(bytes: &mut Vec<u8>, count: usize) -> &mut [u8] {
    let start = bytes.len();
    bytes.resize(start + count, 0);
    &mut bytes[start..]
}
