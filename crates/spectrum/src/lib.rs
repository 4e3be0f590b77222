//! Spectra, colour spaces, blackbody emission and measured metals.
//!
//! [`Spectrum`] represents light and reflectance during rendering. Everything else is for loading a
//! scene: [`SpectrumValue`] and [`SampledSpectrum`] hold spectral data and convert it to colour;
//! [`metal`] and [`refractive_index`] look up named materials.
#![forbid(unsafe_code)]

mod blackbody;
pub mod cie;
pub mod color;
mod conversion;
mod lanes;
mod materials;
mod operators;
mod parse;
mod sampled;
mod spectrum;
mod table;

pub use blackbody::{blackbody_radiance, blackbody_rgb};
pub use conversion::{SpectrumUse, SpectrumValue};
pub use lanes::SpectrumLanes;
pub use materials::{Metal, metal, metal_names, refractive_index, refractive_index_names};
pub use parse::{SpdError, SpectrumValueError, parse_spd};
pub use sampled::{SampleError, SampledSpectrum};
pub use spectrum::Spectrum;
