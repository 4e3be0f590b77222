//! Mitsuba's file format for grid volumes (`.vol`, version 3).
//!
//! Little-endian: the letters `VOL` and the version as a byte. Then, as 32-bit integers: the
//! encoding, the cell counts along x, y and z, and the channel count. Then the bounding box as six
//! floats (minimum corner, maximum corner). Then the values: x varies fastest among the cells, and
//! the channels of a cell are interleaved (Mitsuba 3's manual of `gridvolume`; version 0.6's lists
//! the encodings).

use etendue_math::Bounds3;
use glam::Vec3;
use std::fmt;

/// The size of the header in bytes.
const HEADER: usize = 48;

/// The contents of a file.
#[derive(Clone, Debug)]
pub(crate) struct GridFile {
    /// Cell counts along x, y and z; none is zero.
    pub(crate) size: [u32; 3],
    /// Values per cell: 1, 3 or 6.
    pub(crate) channels: usize,
    /// The bounding box given by the file; not validated.
    pub(crate) bounds: Bounds3,
    /// The values of all cells.
    pub(crate) values: Vec<f32>,
}

/// Why a file cannot be read.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum GridError {
    NotAVolume,
    Truncated { expected: u64, found: usize },
    Version(u8),
    Encoding(i32),
    Size([i32; 3]),
    Channels(i32),
    NotANumber { cell: [u32; 3], value: f32 },
}

impl GridError {
    /// Whether the file may be valid but uses a feature that is not supported.
    pub(crate) fn is_unsupported(&self) -> bool {
        matches!(self, Self::Version(_) | Self::Encoding(_) | Self::Channels(_))
    }
}

impl fmt::Display for GridError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAVolume => {
                write!(formatter, "this is no volume: it does not start with `VOL`")
            }
            Self::Truncated { expected, found } => {
                write!(formatter, "the file has {found} bytes, but its header asks for {expected}")
            }
            Self::Version(version) => {
                write!(formatter, "version {version} is not known; this one is 3")
            }
            Self::Encoding(encoding) => write!(
                formatter,
                "encoding {encoding} is not known; there are 1 (32-bit floats), 2 (16-bit floats) and 3 (bytes)"
            ),
            Self::Size([x, y, z]) => {
                write!(formatter, "a grid of {x} × {y} × {z} cells makes no sense")
            }
            Self::Channels(channels) => {
                write!(formatter, "{channels} values in a cell, where 1, 3 or 6 have a meaning")
            }
            Self::NotANumber { cell: [x, y, z], value } => {
                write!(formatter, "cell {x}, {y}, {z} holds {value}, which is no finite number")
            }
        }
    }
}

/// How the values are encoded.
#[derive(Clone, Copy)]
enum Encoding {
    Float,
    Half,
    Byte,
}

impl Encoding {
    fn bytes(self) -> u64 {
        match self {
            Self::Float => 4,
            Self::Half => 2,
            Self::Byte => 1,
        }
    }

    fn decode(self, bytes: &[u8]) -> Vec<f32> {
        match self {
            Self::Float => {
                bytes.as_chunks().0.iter().map(|four| f32::from_le_bytes(*four)).collect()
            }
            Self::Half => {
                bytes.as_chunks().0.iter().map(|two| half_float(u16::from_le_bytes(*two))).collect()
            }
            Self::Byte => bytes.iter().map(|byte| f32::from(*byte) / 255.0).collect(),
        }
    }
}

/// Converts a 16-bit float (IEEE 754 binary16).
fn half_float(bits: u16) -> f32 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, mantissa) = (i32::from(bits >> 10 & 0x1f), f32::from(bits & 0x3ff));
    sign * match exponent {
        0 => mantissa * 2.0_f32.powi(-24),
        31 if mantissa == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1024.0 + mantissa) * 2.0_f32.powi(exponent - 25),
    }
}

/// Parses a file. Checks all sizes against its length before allocating memory.
pub(crate) fn read(bytes: &[u8]) -> Result<GridFile, GridError> {
    if !bytes.starts_with(b"VOL") {
        return Err(GridError::NotAVolume);
    }
    if bytes.len() < HEADER {
        return Err(GridError::Truncated { expected: HEADER as u64, found: bytes.len() });
    }
    let word = |place: usize| {
        let start = 4 * place;
        [bytes[start], bytes[start + 1], bytes[start + 2], bytes[start + 3]]
    };
    let integer = |place| i32::from_le_bytes(word(place));
    let float = |place| f32::from_le_bytes(word(place));
    if bytes[3] != 3 {
        return Err(GridError::Version(bytes[3]));
    }
    let encoding = match integer(1) {
        1 => Encoding::Float,
        2 => Encoding::Half,
        3 => Encoding::Byte,
        other => return Err(GridError::Encoding(other)),
    };
    let sides = [integer(2), integer(3), integer(4)];
    if sides.iter().any(|side| *side < 1) {
        return Err(GridError::Size(sides));
    }
    let size = sides.map(i32::unsigned_abs);
    let channels = match integer(5) {
        known @ (1 | 3 | 6) => known as usize,
        other => return Err(GridError::Channels(other)),
    };
    let expected = size
        .iter()
        .try_fold(channels as u64 * encoding.bytes(), |product, side| {
            product.checked_mul(u64::from(*side))
        })
        .and_then(|length| length.checked_add(HEADER as u64))
        .ok_or(GridError::Size(sides))?;
    if (bytes.len() as u64) < expected {
        return Err(GridError::Truncated { expected, found: bytes.len() });
    }
    let bounds = Bounds3::new(
        Vec3::new(float(6), float(7), float(8)),
        Vec3::new(float(9), float(10), float(11)),
    );
    // The file is at least this long, so the length fits in a `usize`.
    let values = encoding.decode(&bytes[HEADER..expected as usize]);
    let file = GridFile { size, channels, bounds, values };
    file.check().map(|()| file)
}

impl GridFile {
    /// A grid in memory that fills the unit cube: the cell counts along x, y and z, and all values.
    pub(crate) fn in_unit_cube(
        sides: [usize; 3],
        channels: usize,
        values: Vec<f32>,
    ) -> Result<Self, GridError> {
        let sides = sides.map(|side| i32::try_from(side).unwrap_or(i32::MAX));
        let cells = sides
            .iter()
            .try_fold(channels, |product, side| product.checked_mul(usize::try_from(*side).ok()?));
        if sides.iter().any(|side| *side < 1) || cells != Some(values.len()) {
            return Err(GridError::Size(sides));
        }
        if !matches!(channels, 1 | 3 | 6) {
            return Err(GridError::Channels(i32::try_from(channels).unwrap_or(i32::MAX)));
        }
        let (size, bounds) = (sides.map(i32::unsigned_abs), Bounds3::new(Vec3::ZERO, Vec3::ONE));
        let grid = Self { size, channels, bounds, values };
        grid.check().map(|()| grid)
    }

    /// Rejects NaN and infinity, and reports where the first one is.
    fn check(&self) -> Result<(), GridError> {
        let Some(index) = self.values.iter().position(|value| !value.is_finite()) else {
            return Ok(());
        };
        let cell = (index / self.channels) as u64;
        let [width, height, _] = self.size.map(u64::from);
        let place = [cell % width, cell / width % height, cell / (width * height)];
        Err(GridError::NotANumber {
            cell: place.map(|coordinate| coordinate as u32),
            value: self.values[index],
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A file of 32-bit floats in the unit cube.
    pub(crate) fn file(size: [i32; 3], channels: i32, values: &[f32]) -> Vec<u8> {
        let mut bytes = b"VOL\x03".to_vec();
        for number in [1, size[0], size[1], size[2], channels] {
            bytes.extend(number.to_le_bytes());
        }
        for number in [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0] {
            bytes.extend(number.to_le_bytes());
        }
        values.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
        bytes
    }

    #[test]
    fn what_was_written_is_read() {
        let values: Vec<f32> = (0_u8..18).map(f32::from).collect();
        let read = read(&file([1, 2, 3], 3, &values)).expect("a file");
        assert_eq!((read.size, read.channels), ([1, 2, 3], 3));
        assert_eq!(read.values, values);
        assert_eq!(read.bounds.max, Vec3::ONE);
    }

    #[test]
    fn shorter_encodings_are_read() {
        let mut bytes = file([2, 1, 1], 1, &[]);
        bytes[4] = 3;
        bytes.extend([0, 255]);
        assert_eq!(read(&bytes).expect("bytes").values, [0.0, 1.0]);
        bytes[4] = 2;
        bytes.truncate(HEADER);
        bytes.extend([0x00, 0xbc, 0x01, 0x00]);
        assert_eq!(read(&bytes).expect("halves").values, [-1.0, 2.0_f32.powi(-24)]);
    }

    #[test]
    fn half_floats_have_their_values() {
        let cases = [(0x3c00, 1.0), (0xc000, -2.0), (0x7bff, 65504.0), (0x0400, 6.103_515_6e-5)];
        for (bits, value) in cases {
            assert_eq!(half_float(bits), value);
        }
        assert!(half_float(0x7c00).is_infinite() && half_float(0x7e00).is_nan());
    }

    #[test]
    fn hostile_files_are_refused_by_what_is_wrong() {
        let good = file([1, 1, 2], 1, &[1.0, 2.0]);
        let changed = |place: usize, byte: u8| {
            let mut bytes = good.clone();
            bytes[place] = byte;
            bytes
        };
        assert_eq!(read(b"").err(), Some(GridError::NotAVolume));
        assert_eq!(read(&changed(0, b'X')).err(), Some(GridError::NotAVolume));
        assert_eq!(read(&changed(3, 4)).err(), Some(GridError::Version(4)));
        assert_eq!(read(&changed(4, 9)).err(), Some(GridError::Encoding(9)));
        assert_eq!(read(&changed(8, 0)).err(), Some(GridError::Size([0, 1, 2])));
        assert_eq!(read(&changed(20, 2)).err(), Some(GridError::Channels(2)));
        assert!(matches!(read(&good[..20]), Err(GridError::Truncated { found: 20, .. })));
        assert!(matches!(read(&good[..52]), Err(GridError::Truncated { expected: 56, found: 52 })));
        let huge = file([i32::MAX; 3], 6, &[1.0]);
        assert_eq!(read(&huge).err(), Some(GridError::Size([i32::MAX; 3])));
        let large = file([1 << 20, 1 << 20, 1], 1, &[1.0]);
        assert!(matches!(read(&large), Err(GridError::Truncated { .. })));
        let nan = file([2, 2, 2], 1, &[0.0, 0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0, 0.0]);
        assert!(matches!(read(&nan), Err(GridError::NotANumber { cell: [1, 0, 1], .. })));
    }
}
