//! Statistical tests (chi-squared, z, Welch), quadrature and a random number generator, for tests.
//!
//! A development dependency of the other crates. Everything is deterministic: tests draw from a
//! [`TestRng`] with a fixed seed, so that they pass or fail the same way everywhere.
//!
//! ```
//! use etendue_testkit::ChiSquare;
//! use glam::Vec3;
//!
//! // The uniform distribution over directions, against its density 1 / (4π).
//! ChiSquare::default()
//!     .sphere(
//!         |random| Some(random.unit_vector()),
//!         |_direction: Vec3| 0.25 * std::f32::consts::FRAC_1_PI,
//!     )
//!     .assert();
//! ```
#![forbid(unsafe_code)]

mod chi2;
mod hypothesis;
mod partition;
mod pearson;
pub mod quadrature;
mod random;
mod rectangle;
pub mod special;

pub use chi2::ChiSquare;
pub use hypothesis::{Accumulator, TestOutcome, t_test, welch, z_test};
pub use pearson::{ChiSquareOutcome, Rejection, chi2_discrete};
pub use random::TestRng;
pub use rectangle::Rectangle;
