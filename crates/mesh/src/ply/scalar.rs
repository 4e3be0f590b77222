//! The scalar types of PLY.

/// The type of a property, or of the count or the entries of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ScalarType {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Float32,
    Float64,
}

/// Byte order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

impl ScalarType {
    /// The type with this name. Most types have two names.
    pub(super) fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::Int8,
            "uchar" | "uint8" => Self::Uint8,
            "short" | "int16" => Self::Int16,
            "ushort" | "uint16" => Self::Uint16,
            "int" | "int32" => Self::Int32,
            "uint" | "uint32" => Self::Uint32,
            "float" | "float32" => Self::Float32,
            "double" | "float64" => Self::Float64,
            _ => return None,
        })
    }

    /// Whether this is an integer type.
    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::Float32 | Self::Float64)
    }

    /// The size in bytes.
    #[inline]
    pub(super) fn size(self) -> usize {
        match self {
            Self::Int8 | Self::Uint8 => 1,
            Self::Int16 | Self::Uint16 => 2,
            Self::Int32 | Self::Uint32 | Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }

    /// The number at the start of `bytes`, in single precision. `None` if there are too few bytes.
    #[inline]
    pub(super) fn read_float(self, bytes: &[u8], order: ByteOrder) -> Option<f32> {
        match self {
            Self::Float32 => take(bytes, order, f32::from_le_bytes, f32::from_be_bytes),
            Self::Float64 => {
                take(bytes, order, f64::from_le_bytes, f64::from_be_bytes).map(|value| value as f32)
            }
            _ => self.read_integer(bytes, order).map(|value| value as f32),
        }
    }

    /// The integer at the start of `bytes`. `None` if there are too few bytes or this is not an
    /// integer type.
    #[inline]
    pub(super) fn read_integer(self, bytes: &[u8], order: ByteOrder) -> Option<i64> {
        match self {
            Self::Int8 => take(bytes, order, i8::from_le_bytes, i8::from_be_bytes).map(i64::from),
            Self::Uint8 => take(bytes, order, u8::from_le_bytes, u8::from_be_bytes).map(i64::from),
            Self::Int16 => {
                take(bytes, order, i16::from_le_bytes, i16::from_be_bytes).map(i64::from)
            }
            Self::Uint16 => {
                take(bytes, order, u16::from_le_bytes, u16::from_be_bytes).map(i64::from)
            }
            Self::Int32 => {
                take(bytes, order, i32::from_le_bytes, i32::from_be_bytes).map(i64::from)
            }
            Self::Uint32 => {
                take(bytes, order, u32::from_le_bytes, u32::from_be_bytes).map(i64::from)
            }
            Self::Float32 | Self::Float64 => None,
        }
    }
}

/// Converts the first `N` bytes to a number.
#[inline]
fn take<const N: usize, T>(
    bytes: &[u8],
    order: ByteOrder,
    from_little: impl Fn([u8; N]) -> T,
    from_big: impl Fn([u8; N]) -> T,
) -> Option<T> {
    let chunk = *bytes.first_chunk::<N>()?;
    Some(if order == ByteOrder::Little { from_little(chunk) } else { from_big(chunk) })
}
