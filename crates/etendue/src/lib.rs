//! A physically based path tracer: the library.
#![forbid(unsafe_code)]
