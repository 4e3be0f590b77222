//! Counter-based random numbers, low-discrepancy sequences, warps, distributions and alias tables.
#![forbid(unsafe_code)]
