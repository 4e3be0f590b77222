//! The properties of all kinds of samplers, and those of each.

use super::kind::{SampleSets, SamplerKind};
use super::spec::SamplerSpec;
use etendue_testkit::{Accumulator, chi2_discrete, t_test, welch};
use glam::{UVec2, Vec2};

fn pixel(index: u32) -> UVec2 {
    UVec2::new(index % 97, index / 97)
}

/// The points of one pixel at a dimension.
fn points(spec: &SamplerSpec, pixel: UVec2, dimension: u32, count: u32) -> Vec<Vec2> {
    (0..count)
        .map(|index| {
            let mut sampler = spec.start(pixel, index);
            sampler.set_dimension(dimension);
            sampler.next_2d()
        })
        .collect()
}

#[test]
fn numbers_are_a_function_of_their_place() {
    for kind in SamplerKind::ALL {
        let spec = SamplerSpec::new(kind, 16, 7);
        let mut sampler = spec.start(pixel(5), 3);
        let first: Vec<f32> = (0..20).map(|_| sampler.next_1d()).collect();
        assert_eq!(sampler.dimension(), 20);
        for (dimension, &value) in first.iter().enumerate().rev() {
            sampler.set_dimension(dimension as u32);
            assert_eq!(sampler.next_1d(), value, "{kind:?}");
        }
        let others = [
            spec.start(pixel(6), 3),
            spec.start(pixel(5), 4),
            SamplerSpec::new(kind, 16, 8).start(pixel(5), 3),
        ];
        for mut other in others {
            let same = first.iter().filter(|&&value| other.next_1d() == value).count();
            assert!(same <= 1, "{kind:?}");
        }
    }
}

#[test]
fn numbers_lie_below_one_everywhere() {
    for kind in SamplerKind::ALL {
        for planned in [0, 1, 2, 3, 5, 64, 1000, u32::MAX] {
            let spec = SamplerSpec::new(kind, planned, u64::MAX);
            assert!(spec.rounded_sample_count() >= planned.min(1 << 30));
            for index in [0, 1, 63, 1 << 20, 1 << 31, u32::MAX] {
                let mut sampler = spec.start(UVec2::MAX, index);
                for dimension in [0, 3, 1000, u32::MAX - 1, u32::MAX] {
                    sampler.set_dimension(dimension);
                    let pair = sampler.next_2d();
                    let values = [pair.x, pair.y, sampler.next_1d()];
                    assert!(values.iter().all(|value| (0.0..1.0).contains(value)), "{kind:?}");
                }
            }
        }
    }
}

#[test]
fn each_sample_is_uniform_over_pixels() {
    // One sample per pixel: over the pixels, each dimension and pair of dimensions is uniform,
    // within the plan and beyond it. This is what keeps an estimate unbiased.
    for kind in SamplerKind::ALL {
        for planned in [1, 9, 64] {
            let spec = SamplerSpec::new(kind, planned, 1);
            for (index, dimension) in [(0, 0), (7, 3), (3 * planned + 1, 70), (1 << 30, 1)] {
                let mut cells = [0_u64; 64];
                let mut line = [0_u64; 50];
                for place in 0..20_000 {
                    let mut sampler = spec.start(pixel(place), index);
                    sampler.set_dimension(dimension);
                    let cell = (sampler.next_2d() * 8.0).as_uvec2();
                    cells[(cell.x * 8 + cell.y) as usize] += 1;
                    line[(sampler.next_1d() * 50.0) as usize] += 1;
                }
                for outcome in [chi2_discrete(&cells, &[1.0; 64]), chi2_discrete(&line, &[1.0; 50])]
                {
                    // 192 tests in all: Šidák's level for one false alarm in a hundred runs.
                    assert!(outcome.p_value > 5e-5, "{kind:?} {planned} {index}: {outcome}");
                }
            }
        }
    }
}

/// The correlation of two sequences with mean ½ and variance 1/12, times √n: standard normal.
fn standardised_correlation(pairs: impl Iterator<Item = (f32, f32)>) -> f64 {
    let products: Accumulator =
        pairs.map(|(a, b)| f64::from(a - 0.5) * f64::from(b - 0.5) * 12.0).collect();
    products.mean() * (products.count() as f64).sqrt()
}

#[test]
fn dimensions_pixels_seeds_and_samples_are_uncorrelated() {
    for kind in SamplerKind::ALL {
        let spec = SamplerSpec::new(kind, 16, 3);
        let other_seed = SamplerSpec::new(kind, 16, 4);
        let value = |spec: &SamplerSpec, place: u32, index: u32, dimension: u32| {
            let mut sampler = spec.start(pixel(place), index);
            sampler.set_dimension(dimension);
            sampler.next_1d()
        };
        let mut scores = Vec::new();
        for (a, b) in [(0, 1), (0, 2), (1, 2), (2, 7), (0, 64), (3, 67), (10, 11)] {
            let at = |place, dimension| value(&spec, place, place % 40, dimension);
            scores.push(standardised_correlation((0..20_000).map(|p| (at(p, a), at(p, b)))));
        }
        let own = |place| value(&spec, place, 5, 2);
        scores.push(standardised_correlation((0..20_000).map(|p| (own(p), own(p + 1)))));
        scores.push(standardised_correlation((0..20_000).map(|p| (own(p), own(p + 97)))));
        let seeded = |place| value(&other_seed, place, 5, 2);
        scores.push(standardised_correlation((0..20_000).map(|p| (own(p), seeded(p)))));
        // Samples of different sets; within a set they avoid each other on purpose.
        if kind == SamplerKind::Independent {
            let next = |place| value(&spec, place, 6, 2);
            scores.push(standardised_correlation((0..20_000).map(|p| (own(p), next(p)))));
        }
        for score in scores {
            // 81 tests: 4.3 deviations are passed once in 700 runs.
            assert!(score.abs() < 4.3, "{kind:?}: {score}");
        }
    }
}

/// Asserts that `count` numbers fall into `count` equal strata, one in each.
fn assert_latin(values: impl Iterator<Item = f32>, count: u32, what: &str) {
    let mut seen = vec![false; count as usize];
    for value in values {
        let stratum = (f64::from(value) * f64::from(count)) as usize;
        assert!(!std::mem::replace(&mut seen[stratum], true), "{what}: stratum {stratum} twice");
    }
    assert!(seen.iter().all(|&seen| seen), "{what}");
}

/// Asserts that every cell of a `columns` × `rows` grid holds the same number of points.
fn assert_even(points: &[Vec2], columns: u32, rows: u32, what: &str) {
    let mut counts = vec![0; (columns * rows) as usize];
    for point in points {
        let cell = (*point * Vec2::new(columns as f32, rows as f32)).as_uvec2();
        counts[(cell.y * columns + cell.x) as usize] += 1;
    }
    let share = points.len() / counts.len();
    assert!(counts.iter().all(|&count| count == share), "{what}: {columns} × {rows}");
}

#[test]
fn one_dimension_is_stratified_as_finely_as_there_are_samples() {
    for kind in SamplerKind::ALL.into_iter().filter(|&kind| kind != SamplerKind::Independent) {
        // Halton's first dimension is in base 2, and its second in base 3.
        for (planned, dimension) in [(64, 0), (16, 6), (81, 1), (25, 9)] {
            let in_base = matches!((planned, dimension), (64, 0) | (81, 1));
            let base_two = planned == 64 || planned == 16;
            let skip = match kind {
                SamplerKind::Halton => !in_base,
                SamplerKind::Sobol => !base_two,
                _ => false,
            };
            if skip {
                continue;
            }
            let spec = SamplerSpec::new(kind, planned, 9);
            let count = match kind {
                SamplerKind::Halton | SamplerKind::Sobol => planned,
                _ => spec.rounded_sample_count(),
            };
            for set in [0, 5] {
                let values = (0..count).map(|index| {
                    let mut sampler = spec.start(pixel(3), set * count + index);
                    sampler.set_dimension(dimension);
                    sampler.next_1d()
                });
                assert_latin(values, count, &format!("{kind:?} {planned} set {set}"));
            }
        }
    }
}

#[test]
fn pairs_in_base_two_are_nets() {
    // Every elementary interval of 64 equal ones holds one of 64 points: 64 × 1, 32 × 2, … 1 × 64.
    for kind in [SamplerKind::Sobol, SamplerKind::LowDiscrepancy, SamplerKind::Hammersley] {
        let spec = SamplerSpec::new(kind, 64, 2);
        for dimension in [0, 2, 9, 14] {
            let all = points(&spec, pixel(8), dimension, 256);
            for block in all.chunks(64) {
                for power in 0..=6 {
                    assert_even(block, 64 >> power, 1 << power, &format!("{kind:?} {dimension}"));
                }
            }
        }
    }
}

#[test]
fn sobol_points_are_nets_at_every_power_of_two() {
    let spec = SamplerSpec::new(SamplerKind::Sobol, 1, 2);
    let all = points(&spec, pixel(8), 4, 4096);
    for exponent in 0..=12 {
        for power in 0..=exponent {
            let columns = 1 << (exponent - power);
            assert_even(&all[..1 << exponent], columns, 1 << power, "sobol prefix");
        }
    }
}

#[test]
fn halves_are_two_sequences_that_know_nothing_of_each_other() {
    for kind in [SamplerKind::Sobol, SamplerKind::LowDiscrepancy, SamplerKind::Hammersley] {
        let spec = SamplerSpec::in_halves(kind, 128, 2);
        assert_eq!(spec.rounded_sample_count(), 128);
        let all = points(&spec, pixel(8), 2, 128);
        let half =
            |first: usize| -> Vec<Vec2> { all[first..].iter().step_by(2).copied().collect() };
        for half in [half(0), half(1)] {
            assert_even(&half, 8, 8, &format!("half of {kind:?}"));
        }
        let value = |place: u32, index: u32| {
            let mut sampler = spec.start(pixel(place), index);
            sampler.set_dimension(2);
            sampler.next_1d()
        };
        for distance in [1, 3] {
            let pairs = (0..20_000).map(|p| (value(p, p % 40), value(p, p % 40 + distance)));
            let score = standardised_correlation(pairs);
            assert!(score.abs() < 4.0, "{kind:?}: {score}");
        }
    }
    let independent = SamplerKind::Independent;
    assert_eq!(SamplerSpec::in_halves(independent, 9, 1), SamplerSpec::new(independent, 9, 1));
}

#[test]
fn halton_pairs_fill_their_bases() {
    // 2³ · 3² boxes of the first two dimensions; 5 · 7 of the next two.
    let spec = SamplerSpec::new(SamplerKind::Halton, 1, 2);
    assert_even(&points(&spec, pixel(1), 0, 144), 8, 9, "halton 2, 3");
    assert_even(&points(&spec, pixel(1), 2, 70), 5, 7, "halton 5, 7");
}

#[test]
fn grids_of_strata_are_filled() {
    for planned in [9, 16, 20, 64] {
        for kind in [SamplerKind::Stratified, SamplerKind::Multijitter, SamplerKind::Orthogonal] {
            let spec = SamplerSpec::new(kind, planned, 5);
            let count = spec.rounded_sample_count();
            let SampleSets { columns, rows, .. } = spec.sets;
            for dimension in [0, 2, 5] {
                let set = points(&spec, pixel(2), dimension, count);
                assert_even(&set, columns, rows, &format!("{kind:?}"));
                if kind != SamplerKind::Stratified {
                    assert_latin(set.iter().map(|point| point.x), count, "x");
                    assert_latin(set.iter().map(|point| point.y), count, "y");
                }
            }
        }
    }
}

#[test]
fn all_pairs_of_an_orthogonal_array_are_stratified() {
    let spec = SamplerSpec::new(SamplerKind::Orthogonal, 49, 5);
    assert_eq!(spec.rounded_sample_count(), 49);
    let samples: Vec<Vec<f32>> = (0..49)
        .map(|index| {
            let mut sampler = spec.start(pixel(4), index);
            (0..8).map(|_| sampler.next_1d()).collect()
        })
        .collect();
    for first in 0..8 {
        for second in 0..first {
            let pairs: Vec<Vec2> =
                samples.iter().map(|sample| Vec2::new(sample[first], sample[second])).collect();
            assert_even(&pairs, 7, 7, &format!("columns {first} and {second}"));
        }
    }
    // A pair never straddles two arrays.
    let mut sampler = spec.start(pixel(4), 0);
    sampler.set_dimension(7);
    let _ = sampler.next_2d();
    assert_eq!(sampler.dimension(), 10);
}

#[test]
fn planned_counts_are_rounded_as_the_kind_needs() {
    let rounded = |kind, planned| SamplerSpec::new(kind, planned, 0).rounded_sample_count();
    assert_eq!(rounded(SamplerKind::Independent, 10), 10);
    assert_eq!(rounded(SamplerKind::Stratified, 10), 16);
    assert_eq!(rounded(SamplerKind::Multijitter, 10), 12);
    assert_eq!(rounded(SamplerKind::Orthogonal, 10), 25);
    assert_eq!(rounded(SamplerKind::LowDiscrepancy, 10), 16);
    assert_eq!(rounded(SamplerKind::Sobol, 10), 10);
}

/// The means of a smooth integrand over `count` samples, one per pixel.
fn pixel_means(spec: &SamplerSpec, count: u32) -> Accumulator {
    (0..1500)
        .map(|place| {
            let sum: f64 = (0..count)
                .map(|index| {
                    let mut sampler = spec.start(pixel(place), index);
                    sampler.set_dimension(2);
                    let point = sampler.next_2d();
                    f64::from((3.0 * point.x).sin() * (2.0 * point.y).exp())
                })
                .sum();
            sum / f64::from(count)
        })
        .collect()
}

#[test]
fn means_are_unbiased_and_vary_less_than_independent_ones() {
    // ∫ sin 3x = (1 − cos 3)/3 and ∫ exp 2y = (e² − 1)/2.
    let expected = (1.0 - 3.0_f64.cos()) / 3.0 * 0.5 * 2.0_f64.exp_m1();
    let independent = pixel_means(&SamplerSpec::new(SamplerKind::Independent, 64, 6), 64);
    assert!(t_test(&independent, expected).accepts(1e-3));
    for kind in SamplerKind::ALL.into_iter().filter(|&kind| kind != SamplerKind::Independent) {
        let spec = SamplerSpec::new(kind, 49, 6);
        let count = if kind == SamplerKind::Sobol { 64 } else { spec.rounded_sample_count() };
        let means = pixel_means(&spec, count);
        let test = t_test(&means, expected);
        assert!(test.accepts(1e-3), "{kind:?}: {} {}", means.mean(), test.p_value);
        // Per sample; the sets differ in size.
        let ratio = independent.variance() * 64.0 / (means.variance() * f64::from(count));
        assert!(ratio > 10.0, "{kind:?}: variance ratio {ratio}");
        // A count that cuts a set in two stays unbiased.
        let cut = pixel_means(&spec, count + count / 3);
        assert!(t_test(&cut, expected).accepts(1e-3), "{kind:?}");
        assert!(welch(&cut, &independent).accepts(1e-3), "{kind:?}");
    }
}
