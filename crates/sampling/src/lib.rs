//! Counter-based random numbers, low-discrepancy sequences, warps, distributions and alias tables.
//!
//! * [`Sampler`] draws the random numbers of one camera sample. They are a pure function of seed,
//!   pixel, sample index and dimension. A [`SamplerSpec`] is the plan for all samples of a picture,
//!   from which each sampler starts.
//! * [`warp`]: maps from the unit square to disks, spheres, cones, triangles and so on, each with its
//!   density and its inverse.
//! * [`Distribution1D`], [`Distribution2D`], [`BilinearDistribution2D`], [`AliasTable`],
//!   [`TabulatedFilter`]: tables to sample from.
//!
//! ```
//! use etendue_sampling::{SamplerKind, SamplerSpec, warp};
//! use glam::UVec2;
//!
//! let spec = SamplerSpec::new(SamplerKind::Sobol, 64, 0);
//! let mut sampler = spec.start(UVec2::new(3, 5), 17);
//! let direction = warp::cosine_hemisphere::sample(sampler.next_2d());
//! assert!(direction.z >= 0.0);
//! ```
#![forbid(unsafe_code)]

mod distribution;
pub mod hash;
mod sampler;
pub mod warp;

pub use distribution::{
    AliasSample, AliasTable, BilinearDistribution2D, Distribution1D, Distribution2D, FilterSample,
    TabulatedFilter, WeightError,
};
pub use sampler::{
    PixelSampler, RandomBatch, Sampler, SamplerKind, SamplerSpec, draw_points, draw_vertices,
};
