//! `cargo fuzz run tiff`: see `targets::tiff`.
#![no_main]

#[path = "../src/targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::tiff(bytes));
