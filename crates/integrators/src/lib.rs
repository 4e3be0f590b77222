//! Path, direct, depth, aov and moment integrators.
#![forbid(unsafe_code)]
