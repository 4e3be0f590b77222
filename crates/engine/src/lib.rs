//! Passes, tiles, threads, budgets, cancellation and statistics.
#![forbid(unsafe_code)]
