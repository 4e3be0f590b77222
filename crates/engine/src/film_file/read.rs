//! From bytes to sums. The bytes may come from anywhere: everything is checked.

use std::collections::HashSet;
use std::io::Read;

use super::bytes::{Cursor, HashingReader};
use super::error::FilmFileError;
use super::format::{CHECKSUM_BYTES, FilmRecord, MAGIC, PREFIX_BYTES, VERSION};
use crate::exact_sums::ExactSums;
use crate::film_sums::{FilmLayout, FilmSums, VARIANCE_LAYER};
use crate::nearest::Key;
use crate::region::{Region, TILE_SIDES};
use crate::source::SampleId;
use crate::splats::Splats;
use crate::statistics::{Defect, DefectiveSample, Defects, KEPT};
use crate::tile::{Tile, TileKind};
use etendue_integrators::ChannelKind;

/// The header of a film's file.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFile {
    /// What the file says beside the sums.
    pub record: FilmRecord,
    /// The pixels.
    pub region: Region,
    /// The index of every pixel's first sample.
    pub first_sample: u32,
    /// The least number of samples of any pixel.
    pub samples_per_pixel: u32,
    /// The names of the channels beside colour and alpha.
    pub channel_names: Vec<String>,
    /// One for each name.
    channel_kinds: Vec<ChannelKind>,
    /// Whether samples with odd index are summed apart too, for variances.
    pub variance: bool,
    /// Whether there are splats.
    splats: bool,
    tile_side: u32,
    header: Vec<u8>,
}

/// The longest header that is read.
const MAX_HEADER_BYTES: u32 = 1 << 20;

impl FilmFile {
    /// Reads the header, and leaves `input` at the sums. The checksum comes after them and is not
    /// checked yet.
    ///
    /// # Errors
    ///
    /// [`FilmFileError`] if there is no valid header.
    pub fn read_header(input: &mut dyn Read) -> Result<Self, FilmFileError> {
        let mut prefix = [0; PREFIX_BYTES];
        input.read_exact(&mut prefix).map_err(not_sums_if_short)?;
        let mut cursor = Cursor(prefix.strip_prefix(MAGIC).ok_or(FilmFileError::NotSums)?);
        match cursor.u32()? {
            VERSION => {}
            other => return Err(FilmFileError::Version(other)),
        }
        let length = cursor.u32()?;
        if length > MAX_HEADER_BYTES {
            return Err(FilmFileError::Invalid("its header is too long"));
        }
        let mut header = vec![0; length as usize];
        input.read_exact(&mut header)?;
        let file = Self::parse(&header)?;
        Ok(Self { header: [&prefix[..], &header].concat(), ..file })
    }

    fn parse(header: &[u8]) -> Result<Self, FilmFileError> {
        let mut cursor = Cursor(header);
        let pair = |cursor: &mut Cursor<'_>| Ok((cursor.text()?, cursor.text()?));
        let record = FilmRecord {
            identity: cursor.list(pair)?,
            notes: cursor.list(pair)?,
            planned_samples: cursor.u32()?,
            seconds: cursor.f64()?,
        };
        let [x, y, width, height] = [cursor.u32()?, cursor.u32()?, cursor.u32()?, cursor.u32()?];
        let file = Self {
            record,
            region: Region { x, y, width, height },
            first_sample: cursor.u32()?,
            samples_per_pixel: cursor.u32()?,
            tile_side: cursor.u32()?,
            variance: cursor.u8()? != 0,
            splats: cursor.u8()? != 0,
            channel_names: cursor.list(Cursor::text)?,
            channel_kinds: cursor.list(read_channel_kind)?,
            header: Vec::new(),
        };
        file.check()?;
        Ok(file)
    }

    fn check(&self) -> Result<(), FilmFileError> {
        let Region { x, y, width, height } = self.region;
        // Picture files have signed coordinates.
        let fits = |start: u32, length: u32| {
            length > 0 && start.checked_add(length).is_some_and(|end| i32::try_from(end).is_ok())
        };
        if !fits(x, width) || !fits(y, height) {
            return Err(FilmFileError::Invalid("its region is not valid"));
        }
        if !TILE_SIDES.contains(&self.tile_side) {
            return Err(FilmFileError::Invalid("the size of its tiles is not valid"));
        }
        if self.first_sample.checked_add(self.samples_per_pixel).is_none() {
            return Err(FilmFileError::Invalid("it has too many samples"));
        }
        if self.channel_kinds.len() != self.channel_names.len() {
            return Err(FilmFileError::Invalid("its channels do not match their kinds"));
        }
        if !are_layer_names(&self.channel_names) {
            return Err(FilmFileError::Invalid("the names of its layers are not valid"));
        }
        if !self.record.seconds.is_finite() || self.record.seconds < 0.0 {
            return Err(FilmFileError::Invalid("its time is not valid"));
        }
        Ok(())
    }

    /// Reads the sums that follow the header, and checks the checksum of the whole file.
    ///
    /// `length` is that of the whole file, header included; the sums may take `memory_limit` bytes.
    ///
    /// # Errors
    ///
    /// [`FilmFileError`] if the file is torn or invalid, or the sums exceed the limit.
    pub fn read_sums(
        &self,
        input: &mut dyn Read,
        length: u64,
        memory_limit: u64,
    ) -> Result<FilmSums, FilmFileError> {
        let kind = TileKind {
            mean_channel_count: 0,
            nearest_channel_count: 0,
            variance: self.variance,
            splats: self.splats,
            first_sample: self.first_sample,
        }
        .with_channels(&self.channel_kinds);
        let expected = tile_bytes(self.region.pixel_count(), kind);
        let left = length.saturating_sub(self.header.len() as u64);
        // Before memory is allocated: a header may claim any size.
        if left < expected {
            return Err(FilmFileError::Torn);
        }
        let layout = FilmLayout {
            region: self.region,
            channel_names: self.channel_names.clone(),
            channel_kinds: self.channel_kinds.clone(),
            kind,
            tile_side: self.tile_side,
        };
        let mut film =
            FilmSums::with_layout(layout, memory_limit).map_err(FilmFileError::Engine)?;
        let hasher = blake3::Hasher::new();
        let mut input = HashingReader { inner: input, hasher, left };
        input.hasher.update(&self.header);
        for tile in film.tiles_mut() {
            read_tile(&mut input, tile, kind)?;
        }
        for mut row in film.splats().into_iter().flat_map(Splats::rows) {
            let bytes = input.read(ExactSums::BYTES * row.len() as u64)?;
            read_sums(&mut Cursor(&bytes), &mut row, MAX_SPLATS)?;
            if (0..row.len()).any(|index| !(row.value(index) as f32).is_finite()) {
                return Err(FilmFileError::Invalid("a splat is not finite"));
            }
        }
        let checksum = input.hasher.finalize();
        if input.left != CHECKSUM_BYTES as u64
            || input.read(CHECKSUM_BYTES as u64)? != checksum.as_bytes()
        {
            return Err(FilmFileError::Torn);
        }
        Ok(film)
    }
}

/// Whether names can be those of a picture's channels beside colour, alpha and variances.
fn are_layer_names(names: &[String]) -> bool {
    /// The greatest length that OpenEXR permits.
    const MAX_BYTES: usize = 255;
    /// The names of a developed picture's own channels.
    const OWN: [&str; 8] = ["R", "G", "B", "A", "X", "Y", "Z", VARIANCE_LAYER];
    let is_name = |name: &String| {
        let layer = name.split('.').next().unwrap_or_default();
        (1..=MAX_BYTES).contains(&name.len())
            && !name.contains(char::is_control)
            && !OWN.contains(&name.as_str())
            && layer != VARIANCE_LAYER
    };
    let mut known = HashSet::new();
    names.iter().all(|name| is_name(name) && known.insert(name))
}

/// The bytes of the counts and sums of some pixels.
fn tile_bytes(pixel_count: u64, kind: TileKind) -> u64 {
    pixel_count.saturating_mul(kind.bytes_per_pixel())
}

fn read_tile(
    input: &mut HashingReader<'_>,
    tile: &mut Tile,
    kind: TileKind,
) -> Result<(), FilmFileError> {
    let start = input.read(4 + 8 + 8 + 4)?;
    let mut cursor = Cursor(&start);
    tile.next_sample = cursor.u32()?;
    let Some(given) = tile.next_sample.checked_sub(kind.first_sample) else {
        return Err(FilmFileError::Invalid("a tile ends before its first sample"));
    };
    let (non_finite, negative) = (cursor.u64()?, cursor.u64()?);
    let kept = cursor.u32()?;
    if kept as usize > KEPT {
        return Err(FilmFileError::Invalid("a tile names too many defects"));
    }
    let named = input.read(13 * u64::from(kept))?;
    let first = read_defects(&named, kept)?;
    tile.defects = Defects { non_finite, negative, first };

    let bytes = input.read(tile_bytes(tile.region.pixel_count(), kind))?;
    let mut cursor = Cursor(&bytes);
    for count in &mut tile.counts {
        *count = cursor.u32()?;
        if *count > given {
            return Err(FilmFileError::Invalid("a pixel has more samples than its tile"));
        }
    }
    for (odd, all) in tile.odd_counts.iter_mut().zip(&tile.counts) {
        *odd = cursor.u32()?;
        if *odd > *all {
            return Err(FilmFileError::Invalid("a pixel has more odd samples than samples"));
        }
    }
    read_sums(&mut cursor, &mut tile.sums, given)?;
    read_sums(&mut cursor, &mut tile.odd_sums, given)?;
    if !tile.is_finite() {
        return Err(FilmFileError::Invalid("a pixel is not finite"));
    }
    if kind.nearest_channel_count > 0 {
        read_nearest(&mut cursor, tile, kind.nearest_channel_count)?;
    }
    Ok(())
}

/// Reads the values of the nearest sample of each pixel.
fn read_nearest(
    cursor: &mut Cursor<'_>,
    tile: &mut Tile,
    channel_count: usize,
) -> Result<(), FilmFileError> {
    const INVALID: FilmFileError = FilmFileError::Invalid("a nearest sample is not valid");
    for pixel in 0..tile.counts.len() {
        let key = Key::from_raw([cursor.u32()?, cursor.u32()?]).ok_or(INVALID)?;
        let values: Result<Vec<f32>, _> =
            (0..channel_count).map(|_| cursor.u32().map(f32::from_bits)).collect();
        let values = values?;
        if values.iter().any(|value| !value.is_finite()) {
            return Err(INVALID);
        }
        tile.nearest.add(pixel, key, values.into_iter());
    }
    Ok(())
}

fn read_channel_kind(cursor: &mut Cursor<'_>) -> Result<ChannelKind, FilmFileError> {
    match cursor.u8()? {
        0 => Ok(ChannelKind::Mean),
        1 => Ok(ChannelKind::Nearest),
        _ => Err(FilmFileError::Invalid("a channel has an unknown kind")),
    }
}

/// The most splats of one pixel in a file. A render can add as many again before a sum overflows.
const MAX_SPLATS: u32 = 1 << 31;

fn read_defects(bytes: &[u8], count: u32) -> Result<Vec<DefectiveSample>, FilmFileError> {
    let mut cursor = Cursor(bytes);
    let one = |_| {
        let id = SampleId { index: cursor.u32()?, y: cursor.u32()?, x: cursor.u32()? };
        match cursor.u8()? {
            0 => Ok(DefectiveSample { id, defect: Defect::NonFinite }),
            1 => Ok(DefectiveSample { id, defect: Defect::Negative }),
            _ => Err(FilmFileError::Invalid("a defect has an unknown kind")),
        }
    };
    (0..count).map(one).collect()
}

/// Reads sums of at most `given` values each.
fn read_sums(
    cursor: &mut Cursor<'_>,
    sums: &mut ExactSums,
    given: u32,
) -> Result<(), FilmFileError> {
    let limits: Result<Vec<u16>, _> = (0..sums.len()).map(|_| cursor.u16()).collect();
    let greatest = u64::from(given) << 31;
    for (index, limit) in limits?.into_iter().enumerate() {
        let digits = [cursor.i64()?, cursor.i64()?];
        let is_possible = digits.iter().all(|digit| digit.unsigned_abs() <= greatest);
        if !ExactSums::is_limit(limit) || !is_possible {
            return Err(FilmFileError::Invalid("a sum is not valid"));
        }
        sums.merge_one(index, (limit, digits));
    }
    Ok(())
}

/// A file too short for a prefix is not a film's.
fn not_sums_if_short(error: std::io::Error) -> FilmFileError {
    match FilmFileError::from(error) {
        FilmFileError::Torn => FilmFileError::NotSums,
        other => other,
    }
}
