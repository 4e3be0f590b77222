//! A density on [0, 1] that changes linearly from end to end.
//!
//! *Physically Based Rendering*, 4th edition, 2.4.2, in a form without cancellation.

use crate::hash::ONE_MINUS_EPSILON;

/// A number in [0, 1) with density proportional to the line from `start` to `end` (both ≥ 0).
#[inline]
#[must_use]
pub fn sample(uniform: f32, start: f32, end: f32) -> f32 {
    let sum = start + end;
    if sum <= 0.0 {
        return uniform;
    }
    // Normalised, so that the squares neither underflow nor overflow.
    let (start, end) = (start / sum, end / sum);
    let root = (start * start + uniform * (end - start)).max(0.0).sqrt();
    let denominator = start + root;
    if denominator > 0.0 { (uniform / denominator).min(ONE_MINUS_EPSILON) } else { 0.0 }
}

/// The density per length at `x` in [0, 1]; uniform where both ends are zero.
#[inline]
#[must_use]
pub fn pdf(x: f32, start: f32, end: f32) -> f32 {
    let sum = start + end;
    if sum <= 0.0 {
        return 1.0;
    }
    2.0 * (start + x * (end - start)) / sum
}

/// The uniform number that [`sample`] maps to `x`.
#[inline]
#[must_use]
pub fn invert(x: f32, start: f32, end: f32) -> f32 {
    let sum = start + end;
    if sum <= 0.0 {
        return x;
    }
    (x * (2.0 * start + x * (end - start)) / sum).clamp(0.0, ONE_MINUS_EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::{ChiSquare, TestRng};

    const ENDS: [(f32, f32); 5] = [(1.0, 1.0), (0.2, 3.0), (5.0, 0.1), (1e-30, 3e-30), (0.0, 0.0)];

    #[test]
    fn samples_follow_the_density() {
        for (start, end) in ENDS {
            let draw = |random: &mut TestRng| Some(sample(random.next_f32(), start, end));
            ChiSquare::one_of(5).line((0.0, 1.0), draw, |x| pdf(x, start, end)).assert();
        }
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        for (start, end) in ENDS {
            for step in 0..1000 {
                let uniform = step as f32 / 1000.0;
                let back = invert(sample(uniform, start, end), start, end);
                assert!((back - uniform).abs() < 4e-7, "{start} {end} {uniform} {back}");
            }
        }
    }
}
