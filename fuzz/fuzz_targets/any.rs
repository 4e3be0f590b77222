//! All targets in one program, for machines without a compiler: `ETENDUE_TARGET` names the one to
//! run. `fuzz/run-all.sh` uses it.
#![no_main]

#[path = "../src/targets.rs"]
mod targets;

use std::sync::LazyLock;

static TARGET: LazyLock<targets::Target> = LazyLock::new(|| {
    let wanted = std::env::var("ETENDUE_TARGET").unwrap_or_default();
    let found = targets::ALL.iter().find(|(name, _)| *name == wanted);
    found.unwrap_or_else(|| panic!("ETENDUE_TARGET=`{wanted}` is not a target")).1
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| TARGET(bytes));
