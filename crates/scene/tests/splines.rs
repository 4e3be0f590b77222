//! Surfaces of revolution: crossings are neither missed nor invented.

#[path = "common/splines.rs"]
mod splines;

use etendue_testkit::TestRng;
use rayon::prelude::*;
use splines::{Counts, random_subject};

/// Casts rays at random profiles and compares every crossing with an independent solver.
fn compare(subjects: u64, rays: u64) -> Counts {
    let counts = (0..subjects).into_par_iter().map(|seed| {
        let mut random = TestRng::new(seed);
        random_subject(&mut random).compare(&mut random, rays)
    });
    counts.reduce(Counts::default, |mut sum, counts| {
        sum.add(&counts);
        sum
    })
}

#[test]
fn rays_pass_through_where_another_solver_finds_it() {
    let counts = compare(2_000, 50);
    assert!(counts.is_clean() && counts.crossings > 50_000, "{counts:#?}");
}

/// The same with ten million rays, which takes about a minute on two cores.
#[test]
#[ignore = "slow; `cargo test -- --include-ignored` runs it"]
fn ten_million_rays_pass_through_where_another_solver_finds_it() {
    let counts = compare(100_000, 100);
    assert!(counts.is_clean() && counts.crossings > 5_000_000, "{counts:#?}");
}
