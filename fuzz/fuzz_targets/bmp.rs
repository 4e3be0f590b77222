//! `cargo fuzz run bmp`: see `targets::bmp`.
#![no_main]

#[path = "../src/targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::bmp(bytes));
