//! Nanoseconds per two-dimensional sample of every sampler, and per draw from every table:
//!
//! ```text
//! cargo bench -p etendue-sampling --bench throughput
//! ```
#![allow(clippy::disallowed_macros, reason = "a program on the command line")]

use etendue_sampling::{
    AliasTable, BilinearDistribution2D, Distribution2D, SamplerKind, SamplerSpec, TabulatedFilter,
};
use glam::{UVec2, Vec2};
use std::hint::black_box;
use std::time::Instant;

const SAMPLES: u32 = 1 << 12;
/// Pairs of dimensions per sample: a short path.
const PAIRS: u32 = 16;

fn main() {
    for kind in SamplerKind::ALL {
        // Hidden from the optimiser, because a renderer reads it from a scene.
        let spec = black_box(SamplerSpec::new(kind, 256, 0));
        report(&format!("{kind:?}, pair"), || {
            let mut sum = Vec2::ZERO;
            for index in 0..SAMPLES {
                let mut sampler = spec.start(UVec2::new(index >> 8, 0), index & 255);
                for _ in 0..PAIRS {
                    sum += sampler.next_2d();
                }
            }
            sum
        });
    }
    tables();
}

/// Draws from tables as large as a two-megapixel environment map.
fn tables() {
    let size = (2048, 1024);
    let weights: Vec<f32> =
        (0..size.0 * size.1).map(|index| (index % 977) as f32 * (index % 13) as f32).collect();
    let spec = black_box(SamplerSpec::new(SamplerKind::Independent, 1, 0));
    let draws = |name: &str, draw: &dyn Fn(Vec2) -> Vec2| {
        report(name, || {
            let mut sum = Vec2::ZERO;
            for index in 0..SAMPLES {
                let mut sampler = spec.start(UVec2::new(index, 0), 0);
                for _ in 0..PAIRS {
                    sum += draw(sampler.next_2d());
                }
            }
            sum
        });
    };
    if let Ok(table) = Distribution2D::new(&weights, size) {
        draws("Distribution2D, 2048 × 1024", &|uniform| table.sample(uniform).0);
    }
    if let Ok(table) = BilinearDistribution2D::new(&weights, size) {
        draws("BilinearDistribution2D, 2048 × 1024", &|uniform| table.sample(uniform).0);
    }
    if let Ok(table) = AliasTable::new(&weights) {
        draws("AliasTable, two million", &|uniform| Vec2::splat(table.sample_2d(uniform).rest));
    }
    if let Ok(table) = TabulatedFilter::new(2.0, |x| (1.0 - 0.6 * x * x).min(1.0)) {
        draws("TabulatedFilter, both axes", &|uniform| table.sample_2d(uniform).0);
    }
}

/// Prints the best of many short runs, which escapes most of the machine's other work.
fn report(name: &str, run: impl Fn() -> Vec2) {
    black_box(run());
    let best = (0..300)
        .map(|_| {
            let start = Instant::now();
            black_box(run());
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min);
    let nanoseconds = best * 1e9 / f64::from(SAMPLES * PAIRS);
    println!("{name:40} {nanoseconds:7.2} ns");
}
