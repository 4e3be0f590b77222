//! The exponential distribution: density r·exp(−r x) for x ≥ 0, as of free-flight distances.

use crate::hash::ONE_MINUS_EPSILON;

/// A number ≥ 0; `rate` is one over the mean.
#[inline]
#[must_use]
pub fn sample(uniform: f32, rate: f32) -> f32 {
    -(-uniform).ln_1p() / rate
}

/// The density per length.
#[inline]
#[must_use]
pub fn pdf(x: f32, rate: f32) -> f32 {
    if x < 0.0 { 0.0 } else { rate * (-rate * x).exp() }
}

/// The uniform number that [`sample`] maps to `x`.
#[inline]
#[must_use]
pub fn invert(x: f32, rate: f32) -> f32 {
    (-(-rate * x).exp_m1()).clamp(0.0, ONE_MINUS_EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::{ChiSquare, TestRng};

    #[test]
    fn samples_follow_the_density() {
        for rate in [0.25_f32, 3.0] {
            let draw = |random: &mut TestRng| Some(sample(random.next_f32(), rate));
            ChiSquare::one_of(2).line((0.0, 17.0 / rate), draw, |x| pdf(x, rate)).assert();
        }
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        for step in 0..1000 {
            let uniform = step as f32 / 1000.0;
            assert!((invert(sample(uniform, 2.5), 2.5) - uniform).abs() < 2e-7);
        }
    }
}
