//! Tables of weights to sample from.

mod alias;
mod bilinear_grid;
mod filter;
mod grid;
mod piecewise;

pub use alias::{AliasSample, AliasTable};
pub use bilinear_grid::BilinearDistribution2D;
pub use filter::{FilterSample, TabulatedFilter};
pub use grid::Distribution2D;
pub use piecewise::Distribution1D;

use std::fmt;

/// Why a table of weights is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightError {
    /// There are no weights.
    Empty,
    /// There are more than 2³⁰ weights in a row, or 2³² altogether.
    TooMany,
    /// The number of weights is not the product of width and height.
    Shape {
        /// Weights wanted.
        expected: usize,
        /// Weights given.
        found: usize,
    },
    /// A weight is negative, infinite or NaN.
    Invalid {
        /// The index of the first such weight.
        index: usize,
    },
    /// All weights are zero, or (of a signed table) the positive ones do not outweigh the others:
    /// there is nothing to sample.
    ZeroSum,
}

impl fmt::Display for WeightError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(formatter, "there are no weights"),
            Self::TooMany => write!(formatter, "there are too many weights"),
            Self::Shape { expected, found } => {
                write!(formatter, "expected {expected} weights, found {found}")
            }
            Self::Invalid { index } => {
                write!(formatter, "weight {index} is negative, infinite or not a number")
            }
            Self::ZeroSum => write!(formatter, "the weights do not have a positive sum"),
        }
    }
}

impl std::error::Error for WeightError {}

/// The greatest number of weights in one table row: indices fit 32 bits with room to spare.
const MAX_WEIGHTS: usize = 1 << 30;

/// The sum of the weights, if each is finite and not negative.
fn checked_sum(weights: &[f32]) -> Result<f64, WeightError> {
    if weights.is_empty() {
        return Err(WeightError::Empty);
    }
    if weights.len() > MAX_WEIGHTS {
        return Err(WeightError::TooMany);
    }
    match weights.iter().position(|weight| !(weight.is_finite() && *weight >= 0.0)) {
        Some(index) => Err(WeightError::Invalid { index }),
        None => Ok(weights.iter().map(|&weight| f64::from(weight)).sum()),
    }
}

/// Checks that `weights` is a grid of `width` × `height` and that each weight is valid.
fn check_grid(weights: &[f32], (width, height): (u32, u32)) -> Result<(), WeightError> {
    let expected = width as usize * height as usize;
    if expected != weights.len() {
        return Err(WeightError::Shape { expected, found: weights.len() });
    }
    checked_sum(weights).map(|_| ())
}

/// Fills `cdf` (one longer than `weights`) with the cumulative shares from 0 to 1, and returns the
/// sum. Without any weight the shares are even.
fn fill_cdf(weights: &[f32], cdf: &mut [f32]) -> f64 {
    let sum: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
    let mut running = 0.0;
    cdf[0] = 0.0;
    for (index, &weight) in weights.iter().enumerate() {
        running += f64::from(weight);
        cdf[index + 1] = if sum > 0.0 {
            (running / sum).min(1.0) as f32
        } else {
            (index + 1) as f32 / weights.len() as f32
        };
    }
    // Rounding of the sum must not open a gap before one; nor give trailing zeros a share.
    for (index, &weight) in weights.iter().enumerate().rev() {
        cdf[index + 1] = 1.0;
        if weight > 0.0 {
            break;
        }
        if sum == 0.0 {
            break;
        }
    }
    sum
}

/// The cell of `cdf` (from 0 to 1) that holds `uniform` in [0, 1); never one of no width.
#[inline]
fn find_cell(cdf: &[f32], uniform: f32) -> usize {
    // The first edge above the number ends its cell, which therefore has a width.
    let edge = cdf.partition_point(|&edge| edge <= uniform);
    edge.clamp(1, cdf.len() - 1) - 1
}
