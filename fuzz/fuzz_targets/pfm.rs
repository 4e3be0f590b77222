//! `cargo fuzz run pfm`: see `targets::pfm`.
#![no_main]

#[path = "../src/targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::pfm(bytes));
