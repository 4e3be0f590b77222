//! Arrays that a host shares with the scene: vertices, indices, texels, grids.

use std::fmt;
use std::sync::{Arc, OnceLock};

use half::f16;
use xxhash_rust::xxh3::Xxh3;

/// The elements of a [`Buffer`], in memory owned by the host.
///
/// A host implements this for its own memory, such as a NumPy array; nothing is copied. The
/// elements must not change while a buffer refers to them: several threads build a scene, and the
/// hash of the elements is computed once.
pub trait BufferData: Send + Sync + 'static {
    /// The elements in row-major order, without gaps.
    fn elements(&self) -> Elements<'_>;
}

/// A slice of one of the supported element types.
#[derive(Clone, Copy, Debug)]
pub enum Elements<'a> {
    /// Unsigned bytes.
    U8(&'a [u8]),
    /// Unsigned, 16 bits.
    U16(&'a [u16]),
    /// Unsigned, 32 bits.
    U32(&'a [u32]),
    /// Unsigned, 64 bits.
    U64(&'a [u64]),
    /// Signed, 32 bits.
    I32(&'a [i32]),
    /// Signed, 64 bits.
    I64(&'a [i64]),
    /// Half precision.
    F16(&'a [f16]),
    /// Single precision.
    F32(&'a [f32]),
    /// Double precision.
    F64(&'a [f64]),
}

/// Evaluates an expression with the slice of the actual element type.
macro_rules! for_any_type {
    ($elements:expr, $slice:ident => $result:expr) => {
        match $elements {
            Elements::U8($slice) => $result,
            Elements::U16($slice) => $result,
            Elements::U32($slice) => $result,
            Elements::U64($slice) => $result,
            Elements::I32($slice) => $result,
            Elements::I64($slice) => $result,
            Elements::F16($slice) => $result,
            Elements::F32($slice) => $result,
            Elements::F64($slice) => $result,
        }
    };
}

impl Elements<'_> {
    /// The number of elements.
    pub fn len(&self) -> usize {
        for_any_type!(self, slice => slice.len())
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The element type, for messages: "32-bit floats".
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::U8(_) => "bytes",
            Self::U16(_) => "unsigned 16-bit integers",
            Self::U32(_) => "unsigned 32-bit integers",
            Self::U64(_) => "unsigned 64-bit integers",
            Self::I32(_) => "32-bit integers",
            Self::I64(_) => "64-bit integers",
            Self::F16(_) => "16-bit floats",
            Self::F32(_) => "32-bit floats",
            Self::F64(_) => "64-bit floats",
        }
    }
}

/// A shared array with any number of dimensions. A clone refers to the same elements.
#[derive(Clone)]
pub struct Buffer(Arc<Shared>);

struct Shared {
    data: Box<dyn BufferData>,
    shape: Vec<usize>,
    hash: OnceLock<u128>,
}

/// The number of elements does not match the shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShapeError {
    /// The dimensions.
    pub shape: Vec<usize>,
    /// The number of elements.
    pub count: usize,
}

impl fmt::Display for ShapeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { shape, count } = self;
        write!(formatter, "a buffer of {count} elements cannot have the shape {shape:?}")
    }
}

impl std::error::Error for ShapeError {}

impl Buffer {
    /// A buffer with the given dimensions, slowest first: rows before columns.
    ///
    /// # Errors
    ///
    /// If the product of the dimensions is not the number of elements.
    pub fn new(data: impl BufferData, shape: impl Into<Vec<usize>>) -> Result<Self, ShapeError> {
        let (shape, count) = (shape.into(), data.elements().len());
        let product = shape.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
        if product != Some(count) {
            return Err(ShapeError { shape, count });
        }
        Ok(Self::of(data, shape))
    }

    fn of(data: impl BufferData, shape: Vec<usize>) -> Self {
        Self(Arc::new(Shared { data: Box::new(data), shape, hash: OnceLock::new() }))
    }

    /// The elements in row-major order.
    pub fn elements(&self) -> Elements<'_> {
        self.0.data.elements()
    }

    /// The dimensions, slowest first.
    pub fn shape(&self) -> &[usize] {
        &self.0.shape
    }

    /// The number of rows of `columns` elements, in a buffer of shape `[rows, columns]` or in a
    /// flat one; `None` for any other shape.
    pub fn rows(&self, columns: usize) -> Option<usize> {
        match *self.shape() {
            [rows, found] if found == columns => Some(rows),
            [count] if count % columns == 0 => Some(count / columns),
            _ => None,
        }
    }

    /// The elements in single precision, if they are floats.
    pub fn to_floats(&self) -> Option<Vec<f32>> {
        match self.elements() {
            Elements::F16(values) => Some(values.iter().map(|value| value.to_f32()).collect()),
            Elements::F32(values) => Some(values.to_vec()),
            Elements::F64(values) => Some(values.iter().map(|value| *value as f32).collect()),
            _ => None,
        }
    }

    /// Like [`Self::to_floats`], but 8-bit and 16-bit unsigned integers become fractions of their
    /// maximum.
    pub fn to_fractions(&self) -> Option<Vec<f32>> {
        match self.elements() {
            Elements::U8(values) => Some(values.iter().map(|v| f32::from(*v) / 255.0).collect()),
            Elements::U16(values) => Some(values.iter().map(|v| f32::from(*v) / 65535.0).collect()),
            _ => self.to_floats(),
        }
    }

    /// The elements as indices, if they are integers.
    ///
    /// # Errors
    ///
    /// The first element that does not fit in 32 bits unsigned.
    pub fn to_indices(&self) -> Option<Result<Vec<u32>, i128>> {
        fn convert<T: Copy + Into<i128>>(values: &[T]) -> Result<Vec<u32>, i128> {
            let index = |value: &T| u32::try_from((*value).into()).map_err(|_| (*value).into());
            values.iter().map(index).collect()
        }
        match self.elements() {
            Elements::U8(values) => Some(convert(values)),
            Elements::U16(values) => Some(convert(values)),
            Elements::U32(values) => Some(Ok(values.to_vec())),
            Elements::U64(values) => Some(convert(values)),
            Elements::I32(values) => Some(convert(values)),
            Elements::I64(values) => Some(convert(values)),
            Elements::F16(_) | Elements::F32(_) | Elements::F64(_) => None,
        }
    }

    /// A hash of type, shape and elements. It is computed once for all clones, because rebuilding a
    /// scene after an edit must not read large arrays again. It is strong enough to rule out
    /// collisions.
    pub fn content_hash(&self) -> u128 {
        *self.0.hash.get_or_init(|| {
            let mut hasher = Xxh3::new();
            hasher.update(self.elements().type_name().as_bytes());
            self.shape().iter().for_each(|side| hasher.update(&(*side as u64).to_le_bytes()));
            self.elements().for_each_chunk(|bytes| hasher.update(bytes));
            hasher.digest128()
        })
    }
}

/// The number of elements that are converted to bytes at a time.
const CHUNK: usize = 1024;

impl Elements<'_> {
    /// Passes on the elements as little-endian bytes.
    fn for_each_chunk(&self, mut take: impl FnMut(&[u8])) {
        for_any_type!(self, slice => {
            let mut bytes = Vec::with_capacity(8 * CHUNK);
            for chunk in slice.chunks(CHUNK) {
                bytes.clear();
                chunk.iter().for_each(|element| bytes.extend_from_slice(&element.to_le_bytes()));
                take(&bytes);
            }
        });
    }
}

/// Clones compare equal without reading their elements; other buffers compare by hash.
impl PartialEq for Buffer {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
            || (self.shape() == other.shape() && self.content_hash() == other.content_hash())
    }
}

impl fmt::Debug for Buffer {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Buffer({}, {:?})", self.elements().type_name(), self.shape())
    }
}

/// Makes vectors of an element type, and of rows of it, convertible to buffers.
macro_rules! buffers_of {
    ($($element:ty => $variant:ident),+) => {$(
        impl BufferData for Vec<$element> {
            fn elements(&self) -> Elements<'_> {
                Elements::$variant(self)
            }
        }

        impl<const COLUMNS: usize> BufferData for Vec<[$element; COLUMNS]> {
            fn elements(&self) -> Elements<'_> {
                Elements::$variant(self.as_flattened())
            }
        }

        /// Flat.
        impl From<Vec<$element>> for Buffer {
            fn from(elements: Vec<$element>) -> Self {
                let shape = vec![elements.len()];
                Self::of(elements, shape)
            }
        }

        /// Rows and columns.
        impl<const COLUMNS: usize> From<Vec<[$element; COLUMNS]>> for Buffer {
            fn from(rows: Vec<[$element; COLUMNS]>) -> Self {
                let shape = vec![rows.len(), COLUMNS];
                Self::of(rows, shape)
            }
        }
    )+};
}

buffers_of!(u8 => U8, u16 => U16, u32 => U32, u64 => U64, i32 => I32, i64 => I64);
buffers_of!(f16 => F16, f32 => F32, f64 => F64);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_must_fit_the_elements() {
        assert!(Buffer::new(vec![0.0_f32; 6], [2, 3]).is_ok());
        for shape in [vec![2, 2], vec![], vec![usize::MAX, 6], vec![6, 0]] {
            let error = Buffer::new(vec![0.0_f32; 6], shape.clone()).unwrap_err();
            assert_eq!(error, ShapeError { shape, count: 6 });
        }
        assert!(Buffer::new(Vec::<u8>::new(), [0, 3]).is_ok());
    }

    #[test]
    fn rows_are_counted_in_flat_and_in_shaped_buffers() {
        let buffer = |shape: &[usize]| Buffer::new(vec![0_u32; 6], shape).unwrap();
        assert_eq!(buffer(&[2, 3]).rows(3), Some(2));
        assert_eq!(buffer(&[6]).rows(3), Some(2));
        assert_eq!(buffer(&[6]).rows(4), None);
        assert_eq!(buffer(&[3, 2]).rows(3), None);
        assert_eq!(buffer(&[1, 2, 3]).rows(3), None);
    }

    #[test]
    fn equality_is_that_of_type_shape_and_content() {
        let buffer = Buffer::from(vec![[1.0_f32, 2.0]]);
        assert_eq!(buffer, buffer.clone());
        assert_eq!(buffer, Buffer::from(vec![[1.0_f32, 2.0]]));
        assert_ne!(buffer, Buffer::from(vec![1.0_f32, 2.0]), "another shape");
        assert_ne!(buffer, Buffer::from(vec![[1.0_f64, 2.0]]), "another type");
        assert_ne!(buffer, Buffer::from(vec![[1.0_f32, 3.0]]));
        let not_a_number = Buffer::from(vec![f32::NAN]);
        assert_eq!(not_a_number, Buffer::from(vec![f32::NAN]), "bits are compared");
    }

    #[test]
    fn elements_are_converted_where_that_makes_sense() {
        let bytes = Buffer::from(vec![0_u8, 255]);
        assert_eq!((bytes.to_floats(), bytes.to_fractions()), (None, Some(vec![0.0, 1.0])));
        assert_eq!(bytes.to_indices(), Some(Ok(vec![0, 255])));
        assert_eq!(Buffer::from(vec![3_i64, -1]).to_indices(), Some(Err(-1)));
        assert_eq!(Buffer::from(vec![1_u64 << 32]).to_indices(), Some(Err(1 << 32)));
        assert_eq!(Buffer::from(vec![1.0_f32]).to_indices(), None);
        assert_eq!(Buffer::from(vec![1e300_f64]).to_floats(), Some(vec![f32::INFINITY]));
        let half = Buffer::from(vec![f16::from_f32(0.5)]);
        assert_eq!(half.to_floats(), Some(vec![0.5]));
    }

    /// Memory owned by another component.
    struct Foreign(Arc<[f64]>);

    impl BufferData for Foreign {
        fn elements(&self) -> Elements<'_> {
            Elements::F64(&self.0)
        }
    }

    #[test]
    fn foreign_memory_is_shared_and_let_go() {
        let memory: Arc<[f64]> = Arc::from([1.0, 2.0]);
        let buffer = Buffer::new(Foreign(memory.clone()), [2]).unwrap();
        let again = buffer.clone();
        assert_eq!(Arc::strong_count(&memory), 2, "a clone shares");
        drop((buffer, again));
        assert_eq!(Arc::strong_count(&memory), 1);
    }
}
