//! Test helpers: plugins built from a few nodes or a line of XML.

pub(crate) mod bsdf_cases;
pub(crate) mod emitter_cases;
pub(crate) mod material;
pub(crate) mod node;
