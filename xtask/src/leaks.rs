//! `cargo xtask leaks`: rays aimed at the edges and vertices of closed meshes, none of which may
//! slip through. `--full` aims a hundred million instead of a million.

use crate::workspace::cargo;

/// Runs the example `leaks` of `etendue-bvh`, which counts.
pub(crate) fn run(arguments: &[String]) -> bool {
    let count = match arguments {
        [] => "1000000",
        [flag] if flag == "--full" => "100000000",
        _ => {
            eprintln!("usage: cargo xtask leaks [--full]");
            return false;
        }
    };
    let example =
        ["run", "--quiet", "--release", "--package", "etendue-bvh", "--example", "leaks", "--"];
    cargo().args(example).arg(count).status().is_ok_and(|status| status.success())
}
