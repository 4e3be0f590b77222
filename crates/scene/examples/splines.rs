//! Counts what surfaces of revolution miss and invent: `splines [COUNT]` casts that many rays (a
//! million, if not given) at random profiles, and compares every place where they pass through with
//! what another way of solving finds.
#![allow(
    clippy::disallowed_macros,
    clippy::disallowed_methods,
    reason = "a program on the command line"
)]

#[path = "../tests/common/splines.rs"]
mod splines;

use etendue_testkit::TestRng;
use rayon::prelude::*;
use splines::{Counts, random_subject};
use std::error::Error;

/// Rays for each profile.
const RAYS: u64 = 100;

fn main() -> Result<(), Box<dyn Error>> {
    let count: u64 = std::env::args().nth(1).map_or(Ok(1_000_000), |count| count.parse())?;
    let counts = (0..count.div_ceil(RAYS))
        .into_par_iter()
        .map(|seed| {
            let mut random = TestRng::new(seed);
            random_subject(&mut random).compare(&mut random, RAYS)
        })
        .reduce(Counts::default, |mut sum, counts| {
            sum.add(&counts);
            sum
        });
    println!("{counts:#?}");
    if counts.is_clean() { Ok(()) } else { Err("the surface is not exact".into()) }
}
