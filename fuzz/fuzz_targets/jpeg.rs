//! `cargo fuzz run jpeg`: see `targets::jpeg`.
#![no_main]

#[path = "../src/targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::jpeg(bytes));
