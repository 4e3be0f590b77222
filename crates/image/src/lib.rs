//! Bitmaps, codecs from and to bytes, error metrics and tone mapping.
#![forbid(unsafe_code)]
