//! Surfaces of revolution: nothing missed, nothing invented. `examples/splines.rs` casts more rays.

#[path = "common/splines.rs"]
mod splines;

use etendue_testkit::TestRng;
use splines::{Counts, random_subject};

#[test]
fn rays_pass_through_where_another_solver_finds_it() {
    let mut counts = Counts::default();
    for seed in 0..2000 {
        let mut random = TestRng::new(seed);
        counts.add(&random_subject(&mut random).compare(&mut random, 50));
    }
    assert!(counts.is_clean() && counts.crossings > 50_000, "{counts:#?}");
}
