//! Tables of weights to sample from.

mod alias;
mod bilinear_grid;
mod cdf;
mod filter;
mod grid;
mod piecewise;
mod weights;

pub use alias::{AliasSample, AliasTable};
pub use bilinear_grid::BilinearDistribution2D;
pub use filter::{FilterSample, TabulatedFilter};
pub use grid::Distribution2D;
pub use piecewise::Distribution1D;
pub use weights::WeightError;
