//! Models that several plugins share, and the files that some of them read.

pub mod bsdf_inputs;
pub mod coat;
pub mod connection;
pub mod curve_file;
pub mod disney;
pub mod ellipsoid_file;
pub mod erf;
pub mod field_of_view;
pub mod fresnel;
pub mod grid_file;
pub mod image_plane;
pub mod majorants;
pub mod mesh;
pub mod microfacet;
pub(crate) mod picture_in_memory;
pub mod placement;
pub mod profile;
pub mod texels;
pub mod uv;
