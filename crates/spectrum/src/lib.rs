//! Spectra, colour spaces, blackbody emission and measured metals.
#![forbid(unsafe_code)]

pub mod colour;
mod operators;
mod spectrum;

pub use spectrum::Spectrum;
