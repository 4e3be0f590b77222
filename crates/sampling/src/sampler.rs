//! The random numbers of one camera sample, as a function of seed, pixel, sample index, dimension.
//!
//! No state passes from one sample to the next. A picture therefore does not depend on threads, tiles
//! or passes, and any sample can be replayed.

mod draw;
mod halton;
mod hammersley;
mod kind;
mod lanes;
mod low_discrepancy;
mod multijitter;
mod orthogonal;
mod sobol;
mod spec;
mod state;
mod stratified;

pub use kind::SamplerKind;
pub use lanes::{RandomBatch, draw_points, draw_vertices};
pub use spec::{PixelSampler, SamplerSpec};
pub use state::Sampler;

#[cfg(test)]
mod tests;
