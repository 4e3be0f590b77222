//! Models shared by several plugins: scattering, geometry, cameras.

pub mod bsdf_inputs;
pub mod coat;
pub mod connection;
pub mod disney;
pub mod erf;
pub mod fresnel;
pub mod image_plane;
pub mod majorants;
pub mod mesh;
pub mod microfacet;
pub mod placement;
pub mod profile;
