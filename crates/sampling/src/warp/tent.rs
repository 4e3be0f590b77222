//! The tent on [−1, 1]: density 1 − |x|.

use crate::hash::ONE_MINUS_EPSILON;

/// A number in [−1, 1] that follows the tent. Scale it for other widths.
#[inline]
#[must_use]
pub fn sample(uniform: f32) -> f32 {
    if uniform < 0.5 { (2.0 * uniform).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * uniform).sqrt() }
}

/// The density per length.
#[inline]
#[must_use]
pub fn pdf(x: f32) -> f32 {
    (1.0 - x.abs()).max(0.0)
}

/// The uniform number that [`sample`] maps to `x`, which is clamped to [−1, 1].
#[inline]
#[must_use]
pub fn invert(x: f32) -> f32 {
    let rest = (1.0 - x.abs()).max(0.0);
    let tail = 0.5 * rest * rest;
    if x < 0.0 { tail } else { (1.0 - tail).min(ONE_MINUS_EPSILON) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::test_support::assert_round_trip;
    use etendue_testkit::ChiSquare;
    use glam::Vec2;

    #[test]
    fn samples_follow_the_density() {
        // The very end (from the number zero) has no density: a sample there is a failure.
        let draw = |uniform: f32| Some(sample(uniform)).filter(|x| x.abs() < 1.0);
        ChiSquare::default().line((-1.0, 1.0), |random| draw(random.next_f32()), pdf).assert();
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        assert_round_trip(|u| sample(u.x), |x| Vec2::new(invert(x), 0.5), 0.5 + 1e-6);
        for step in 0..1000 {
            let uniform = step as f32 / 1000.0;
            assert!((invert(sample(uniform)) - uniform).abs() < 2e-7);
        }
    }
}
