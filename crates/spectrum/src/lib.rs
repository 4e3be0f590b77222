//! Spectra, colour spaces, blackbody emission and measured metals.
#![forbid(unsafe_code)]
