//! Replays all inputs that fuzzing has found: every file of `fuzz/findings/TARGET`, named after its
//! defect.
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "the corpus is read from files; a file that fails is named"
)]

#[path = "../../../fuzz/src/targets.rs"]
mod targets;

use std::fs;
use std::path::Path;

#[test]
fn what_was_found_once_is_no_trouble_any_more() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/findings");
    let mut count = 0;
    for (name, target) in targets::ALL {
        for entry in fs::read_dir(folder.join(name)).into_iter().flatten() {
            let path = entry.unwrap().path();
            eprintln!("{}", path.display());
            target(&fs::read(&path).unwrap());
            count += 1;
        }
    }
    assert!(count > 0, "there is nothing in {}", folder.display());
}
