//! Checks of weights.

use std::fmt;

/// Why a table cannot be made from some weights.
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
    /// There is nothing to sample: all weights are zero, or (of a signed table) their sum is not
    /// positive.
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

/// The greatest number of weights in one table row: indices fit 32 bits.
const MAX_WEIGHTS: usize = 1 << 30;

/// The sum of the weights, if each is finite and not negative.
pub(super) fn checked_sum(weights: &[f32]) -> Result<f64, WeightError> {
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
pub(super) fn check_grid(weights: &[f32], (width, height): (u32, u32)) -> Result<(), WeightError> {
    let expected = width as usize * height as usize;
    if expected != weights.len() {
        return Err(WeightError::Shape { expected, found: weights.len() });
    }
    checked_sum(weights).map(|_| ())
}
