//! Spectra, colour spaces, blackbody emission and measured metals.
//!
//! [`Spectrum`] is what light and reflectance are carried in while rendering. Everything else
//! here runs while a scene is read: [`SpectrumValue`] and [`SampledSpectrum`] hold spectral data
//! and turn it into colour, [`metal`] and [`refractive_index`] know named materials.
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
