//! Build errors.

use std::fmt;

/// Why [`Bvh::build`](crate::Bvh::build) rejected its input. Geometries and primitives are given by
/// their indices in the input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BuildError {
    /// A triangle refers to a vertex that its mesh does not have.
    IndexOutOfRange {
        /// The mesh.
        geometry: u32,
        /// The triangle.
        primitive: u32,
        /// The vertex index.
        index: u32,
        /// The number of vertices in the mesh.
        vertex_count: usize,
    },
    /// A vertex of a triangle has a coordinate that is infinite or NaN.
    NonFiniteVertex {
        /// The mesh.
        geometry: u32,
        /// The triangle.
        primitive: u32,
    },
    /// The box of a user primitive has a coordinate that is infinite or NaN.
    NonFiniteBounds {
        /// The set of user primitives.
        geometry: u32,
        /// The primitive.
        primitive: u32,
    },
    /// The transform of an instance is not finite or has no finite inverse.
    SingularTransform {
        /// The instance.
        geometry: u32,
    },
    /// The group of an instance contains instances itself.
    NestedInstance {
        /// The outer instance.
        geometry: u32,
    },
    /// More primitives or geometries than a hierarchy can index.
    TooManyPrimitives,
}

impl fmt::Display for BuildError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IndexOutOfRange { geometry, primitive, index, vertex_count } => write!(
                formatter,
                "triangle {primitive} of geometry {geometry} refers to vertex {index}, but the mesh has {vertex_count} vertices"
            ),
            Self::NonFiniteVertex { geometry, primitive } => write!(
                formatter,
                "triangle {primitive} of geometry {geometry} has a vertex that is not finite"
            ),
            Self::NonFiniteBounds { geometry, primitive } => write!(
                formatter,
                "the box of primitive {primitive} of geometry {geometry} is not finite"
            ),
            Self::SingularTransform { geometry } => {
                write!(formatter, "the transform of instance {geometry} has no finite inverse")
            }
            Self::NestedInstance { geometry } => {
                write!(formatter, "the group of instance {geometry} contains instances itself")
            }
            Self::TooManyPrimitives => {
                write!(formatter, "more primitives than one hierarchy can index")
            }
        }
    }
}

impl std::error::Error for BuildError {}
