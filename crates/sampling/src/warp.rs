//! Maps from uniform numbers to other distributions, each with its density and its inverse.
//!
//! Every module holds `sample` (uniform numbers in [0, 1) to the target), `pdf` (the density at a
//! point of the target: per area, solid angle or length) and `invert` (the numbers that `sample`
//! maps to a point). Directions are unit vectors about +z.

pub mod bilinear;
pub mod concentric_disk;
pub mod cosine_hemisphere;
pub mod exponential;
pub mod linear;
pub mod normal;
mod spherical_rectangle;
pub mod tent;
pub mod uniform_cone;
pub mod uniform_hemisphere;
pub mod uniform_sphere;
pub mod uniform_triangle;

pub use spherical_rectangle::SphericalRectangle;

#[cfg(test)]
mod test_support;
