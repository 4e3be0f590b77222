//! `cargo fuzz run obj`: see `targets::obj`.
#![no_main]

#[path = "../src/targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::obj(bytes));
