//! `cargo xtask counts`: rays by the million that must not leak between triangles, nor miss or invent
//! a place where they pass through a spline surface. The tests of the crates cast fewer.

use crate::workspace::cargo;

/// A program that counts, and how many rays it casts in short and in full.
struct Count {
    package: &'static str,
    example: &'static str,
    rays: [&'static str; 2],
}

const COUNTS: &[Count] = &[
    Count { package: "etendue-bvh", example: "leaks", rays: ["1000000", "100000000"] },
    Count { package: "etendue-render", example: "splines", rays: ["1000000", "10000000"] },
];

/// Runs every count; the only argument is `--full`.
pub(crate) fn run(arguments: &[String]) -> bool {
    let is_full = arguments.iter().any(|argument| argument == "--full");
    COUNTS.iter().fold(true, |all_well, count| {
        println!("== {}", count.example);
        let start = ["run", "--quiet", "--release", "--package", count.package, "--example"];
        let rays = count.rays[usize::from(is_full)];
        let status = cargo().args(start).args([count.example, "--", rays]).status();
        status.is_ok_and(|status| status.success()) && all_well
    })
}
