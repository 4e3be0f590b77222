//! Chi-squared, z-test, furnace and ray oracles for tests.
#![forbid(unsafe_code)]
