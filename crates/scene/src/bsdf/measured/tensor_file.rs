//! The file format of the RGL material database: named arrays in one file.
//!
//! Little-endian. The header is `tensor_file`, a zero byte, a two-byte version and the number of
//! fields. For each field, its name, dimensions, type, offset in the file and extents follow. Then
//! comes the data.

use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};

const MAGIC: &[u8] = b"tensor_file\0";
const VERSION: [u8; 2] = [1, 0];
/// No such file has more fields or dimensions than this.
const MAX_FIELDS: u32 = 256;
const MAX_DIMENSIONS: u16 = 8;

/// An array of numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tensor<'a> {
    pub(super) kind: NumberKind,
    extents: [usize; MAX_DIMENSIONS as usize],
    dimensions: usize,
    bytes: &'a [u8],
}

/// The number types that measurements use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberKind {
    /// Bytes: text and flags.
    Uint8,
    /// Four-byte floats.
    Float32,
    /// Any other type, of which only the size is known.
    Other,
}

/// A defect of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum TensorError {
    /// It has another format.
    NotATensorFile,
    /// It is truncated.
    Truncated,
    /// It contains an impossible number.
    Invalid(&'static str),
}

impl Display for TensorError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotATensorFile => formatter.write_str("this is no tensor file of version 1.0"),
            Self::Truncated => formatter.write_str("the file ends too early"),
            Self::Invalid(what) => write!(formatter, "the file has {what}"),
        }
    }
}

impl<'a> Tensor<'a> {
    /// The extent of each dimension, the slowest first.
    pub(super) fn shape(&self) -> &[usize] {
        &self.extents[..self.dimensions]
    }

    /// All numbers of a float tensor.
    pub(super) fn floats(&self) -> impl Iterator<Item = f32> + 'a {
        let quadruples = self.bytes.chunks_exact(4);
        quadruples.map(|bytes| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    }

    /// The raw bytes of the numbers.
    pub(super) fn bytes(&self) -> &'a [u8] {
        self.bytes
    }
}

/// Reads the fields of a file without copying. Every array borrows from `bytes`.
pub(super) fn read(bytes: &[u8]) -> Result<BTreeMap<&[u8], Tensor<'_>>, TensorError> {
    let mut reader = Reader { bytes, place: 0 };
    if reader.take(MAGIC.len()) != Ok(MAGIC) || reader.take(2) != Ok(&VERSION) {
        return Err(TensorError::NotATensorFile);
    }
    let count = u32::from_le_bytes(reader.array()?);
    if count > MAX_FIELDS {
        return Err(TensorError::Invalid("too many fields"));
    }
    (0..count).map(|_| reader.field()).collect()
}

struct Reader<'a> {
    bytes: &'a [u8],
    place: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], TensorError> {
        let rest = self.bytes.get(self.place..).unwrap_or_default();
        let taken = rest.get(..count).ok_or(TensorError::Truncated)?;
        self.place += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], TensorError> {
        self.take(N)?.try_into().map_err(|_| TensorError::Truncated)
    }

    fn field(&mut self) -> Result<(&'a [u8], Tensor<'a>), TensorError> {
        let name_length = u16::from_le_bytes(self.array()?);
        let name = self.take(usize::from(name_length))?;
        let dimensions = u16::from_le_bytes(self.array()?);
        if dimensions > MAX_DIMENSIONS {
            return Err(TensorError::Invalid("too many dimensions"));
        }
        let (kind, size) = match self.array::<1>()?[0] {
            1 => (NumberKind::Uint8, 1),
            10 => (NumberKind::Float32, 4),
            2 => (NumberKind::Other, 1),
            3 | 4 | 9 => (NumberKind::Other, 2),
            5 | 6 => (NumberKind::Other, 4),
            7 | 8 | 11 => (NumberKind::Other, 8),
            _ => return Err(TensorError::Invalid("an unknown type of numbers")),
        };
        let place = u64::from_le_bytes(self.array()?);
        let mut extents = [0; MAX_DIMENSIONS as usize];
        for extent in extents.iter_mut().take(usize::from(dimensions)) {
            let long = u64::from_le_bytes(self.array()?);
            *extent = usize::try_from(long).map_err(|_| TensorError::Truncated)?;
        }
        let dimensions = usize::from(dimensions);
        let length = extents[..dimensions]
            .iter()
            .try_fold(size, |length: usize, extent| length.checked_mul(*extent));
        let data = usize::try_from(place)
            .ok()
            .zip(length)
            .and_then(|(place, length)| self.bytes.get(place..)?.get(..length));
        let bytes = data.ok_or(TensorError::Truncated)?;
        Ok((name, Tensor { kind, extents, dimensions, bytes }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::TestRng;

    const FILE: &[u8] = include_bytes!("isotropic.bsdf");

    #[test]
    fn fields_have_their_shapes() {
        let fields = read(FILE).expect("a file");
        assert_eq!(fields[&b"rgb"[..]].shape(), [1, 4, 3, 6, 6]);
        assert_eq!(fields[&b"theta_i"[..]].floats().next(), Some(0.0));
        assert_eq!(fields[&b"description"[..]].bytes(), b"made for tests");
        assert_eq!(fields[&b"jacobian"[..]].kind, NumberKind::Uint8);
    }

    #[test]
    fn every_cut_is_found() {
        for length in 0..FILE.len() {
            assert!(read(&FILE[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn damaged_heads_do_no_harm() {
        let mut random = TestRng::new(21);
        for _ in 0..20_000 {
            let mut bytes = FILE.to_vec();
            for _ in 0..4 {
                let place = random.below(400) as usize;
                bytes[place] = random.below(256) as u8;
            }
            let Ok(fields) = read(&bytes) else { continue };
            let total: usize = fields.values().map(|tensor| tensor.bytes().len()).sum();
            assert!(total <= fields.len() * bytes.len());
        }
    }
}
