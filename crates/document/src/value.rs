//! The types of parameter values.

use glam::{DAffine3, DMat4, DVec3, Vec3};

use crate::buffer::Buffer;
use crate::transform::{is_affine, look_at_matrix};

/// A typed parameter value.
///
/// `From` converts Rust's own types, so that [`Node::with`](crate::Node::with) accepts them. For
/// three numbers, [`rgb`], [`point`] or [`vector`] states their meaning.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// True or false.
    Boolean(bool),
    /// An integer.
    Integer(i64),
    /// A real number.
    Float(f64),
    /// A text: a file name, a choice, the name of a material.
    String(String),
    /// A position.
    Point(DVec3),
    /// A direction or a size.
    Vector(DVec3),
    /// A colour in linear Rec. 709 (the primaries of sRGB), unbounded above.
    Rgb(DVec3),
    /// A quantity that varies with wavelength.
    Spectrum(SpectrumValue),
    /// The spectrum of a black body.
    Blackbody {
        /// In kelvin.
        temperature: f64,
        /// A scale of the radiance.
        scale: f64,
    },
    /// A transformation of column vectors, from local to outer space. It is stored inline although
    /// it is four times as large as the other variants: a million boxes would each cost an
    /// allocation, and their memory would not return to the system with the document.
    Transform(DAffine3),
    /// The control points of a `<curve>`.
    Points(Vec<DVec3>),
    /// A shared array: vertices, indices, texels, a grid. Only documents built in code have them.
    Buffer(Buffer),
}

impl Value {
    /// A transformation given by a matrix. The last row is assumed to be (0, 0, 0, 1).
    pub fn transform(matrix: DMat4) -> Self {
        Self::Transform(DAffine3::from_mat4(matrix))
    }

    /// The value's type, with its article, for messages: "a number".
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Boolean(_) => "a boolean",
            Self::Integer(_) => "an integer",
            Self::Float(_) => "a number",
            Self::String(_) => "a string",
            Self::Point(_) => "a point",
            Self::Vector(_) => "a vector",
            Self::Rgb(_) => "an RGB colour",
            Self::Spectrum(_) => "a spectrum",
            Self::Blackbody { .. } => "a black body",
            Self::Transform(_) => "a transform",
            Self::Points(_) => "a list of points",
            Self::Buffer(_) => "a buffer",
        }
    }
}

/// A colour in linear Rec. 709.
pub fn rgb(channels: impl Into<DVec3>) -> Value {
    Value::Rgb(channels.into())
}

/// A position.
pub fn point(coordinates: impl Into<DVec3>) -> Value {
    Value::Point(coordinates.into())
}

/// A direction or a size.
pub fn vector(coordinates: impl Into<DVec3>) -> Value {
    Value::Vector(coordinates.into())
}

/// The placement of a camera at `origin` that looks at `target`: see [`look_at_matrix`]. An
/// impossible view becomes a transform that the document rejects.
pub fn look_at(origin: impl Into<DVec3>, target: impl Into<DVec3>, up: impl Into<DVec3>) -> Value {
    let matrix = look_at_matrix(origin.into(), target.into(), up.into());
    matrix.map_or(Value::Transform(DAffine3::NAN), Value::transform)
}

/// Implements `From` with an expression.
macro_rules! values_from {
    ($($from:ty: $name:ident => $value:expr),+ $(,)?) => {$(
        impl From<$from> for Value {
            fn from($name: $from) -> Self {
                $value
            }
        }
    )+};
}

values_from! {
    bool: boolean => Self::Boolean(boolean),
    i64: integer => Self::Integer(integer),
    i32: integer => Self::Integer(integer.into()),
    u32: integer => Self::Integer(integer.into()),
    f64: float => Self::Float(float),
    f32: float => Self::Float(float.into()),
    &str: text => Self::String(text.to_owned()),
    String: text => Self::String(text),
    DVec3: vector => Self::Vector(vector),
    Vec3: vector => Self::Vector(vector.as_dvec3()),
    [f64; 3]: vector => Self::Vector(vector.into()),
    DAffine3: transform => Self::Transform(transform),
    SpectrumValue: spectrum => Self::Spectrum(spectrum),
    Vec<DVec3>: points => Self::Points(points),
    Buffer: buffer => Self::Buffer(buffer),
}

/// A matrix that is not affine becomes NaN, which a document rejects.
impl From<DMat4> for Value {
    fn from(matrix: DMat4) -> Self {
        let affine = DAffine3::from_mat4(matrix);
        Self::Transform(if is_affine(matrix) { affine } else { DAffine3::NAN })
    }
}

/// Implements `From` for vectors that become buffers, flat or in rows.
macro_rules! values_from_vectors {
    ($($element:ty),+) => {$(
        impl From<Vec<$element>> for Value {
            fn from(elements: Vec<$element>) -> Self {
                Self::Buffer(elements.into())
            }
        }

        impl<const COLUMNS: usize> From<Vec<[$element; COLUMNS]>> for Value {
            fn from(rows: Vec<[$element; COLUMNS]>) -> Self {
                Self::Buffer(rows.into())
            }
        }
    )+};
}

values_from_vectors!(u8, u16, u32, u64, i32, i64, half::f16, f32, f64);

/// A quantity that varies with wavelength.
#[derive(Clone, Debug, PartialEq)]
pub enum SpectrumValue {
    /// The same at every wavelength.
    Constant(f64),
    /// Pairs of wavelength in nanometres and value, by ascending wavelength.
    Samples(Vec<(f64, f64)>),
    /// The name of an `.spd` file as written; see [`crate::Document::resolve`].
    File(String),
}
