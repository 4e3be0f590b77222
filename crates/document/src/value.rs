//! The values a parameter may have.

use glam::{DAffine3, DMat4, DVec3};

/// A typed parameter value, as the file states it.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// True or false.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// A real number.
    Float(f64),
    /// A text: a file name, a choice, the name of a material.
    String(String),
    /// A position.
    Point(DVec3),
    /// A direction or a size.
    Vector(DVec3),
    /// A colour in linear Rec. 709 (the primaries of sRGB), without a bound above.
    Rgb(DVec3),
    /// A quantity over wavelengths.
    Spectrum(SpectrumValue),
    /// The spectrum of a black body.
    Blackbody {
        /// In kelvin.
        temperature: f64,
        /// A factor on the radiance.
        scale: f64,
    },
    /// A transformation of column vectors, from the local space to the outer one. In place, though it
    /// is four times as large as anything else: of a million, each would pay for its allocation, and
    /// the memory would not go back to the system when the document does.
    Transform(DAffine3),
    /// The control points of a `<curve>`.
    Points(Vec<DVec3>),
}

impl Value {
    /// A transformation by a matrix whose last row is (0, 0, 0, 1); others are taken as if it were.
    pub fn transform(matrix: DMat4) -> Self {
        Self::Transform(DAffine3::from_mat4(matrix))
    }

    /// What the value is, with its article, for messages: "a number".
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
        }
    }
}

/// A quantity over wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub enum SpectrumValue {
    /// The same at every wavelength.
    Constant(f64),
    /// Pairs of wavelength in nanometres and value, in ascending order of wavelength.
    Samples(Vec<(f64, f64)>),
    /// The name of an `.spd` file as written; see [`crate::Document::resolve`].
    File(String),
}
