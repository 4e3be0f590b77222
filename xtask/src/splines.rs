//! `cargo xtask splines`: rays at random spline surfaces, compared with another way of solving; none
//! of their crossings may be missed or invented. `--full` casts ten million instead of half a million.

use crate::workspace::cargo;

/// Runs the example `splines` of `etendue-scene`, which counts.
pub(crate) fn run(arguments: &[String]) -> bool {
    let count = match arguments {
        [] => "500000",
        [flag] if flag == "--full" => "10000000",
        _ => {
            eprintln!("usage: cargo xtask splines [--full]");
            return false;
        }
    };
    let example =
        ["run", "--quiet", "--release", "--package", "etendue-scene", "--example", "splines", "--"];
    cargo().args(example).arg(count).status().is_ok_and(|status| status.success())
}
