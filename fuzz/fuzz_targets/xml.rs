//! `cargo fuzz run xml`: see `targets::xml`.
#![no_main]

#[path = "../src/targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::xml(bytes));
