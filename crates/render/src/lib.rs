//! The plugins, the registry, and the frozen scene.
#![forbid(unsafe_code)]
