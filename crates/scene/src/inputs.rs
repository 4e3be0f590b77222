//! Inputs shared by plugins: files, and parameters that several plugins accept.

pub(crate) mod curve_file;
pub(crate) mod ellipsoid_file;
pub(crate) mod field_of_view;
pub(crate) mod grid_file;
pub(crate) mod picture_in_memory;
pub(crate) mod texels;
pub(crate) mod transform;
pub(crate) mod uv;
