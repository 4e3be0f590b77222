//! Directions uniform above the horizon.

use super::uniform_cone;
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// A uniform direction with z ≥ 0.
#[inline]
#[must_use]
pub fn sample(uniform: Vec2) -> Vec3 {
    uniform_cone::sample(uniform, 1.0)
}

/// The density per solid angle: 1/2π above the horizon.
#[inline]
#[must_use]
pub fn pdf(direction: Vec3) -> f32 {
    if direction.z >= 0.0 { 0.5 * FRAC_1_PI } else { 0.0 }
}

/// The uniform numbers that [`sample`] maps to a direction above the horizon.
#[inline]
#[must_use]
pub fn invert(direction: Vec3) -> Vec2 {
    uniform_cone::invert(direction, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::test_support::assert_round_trip;
    use etendue_testkit::ChiSquare;

    #[test]
    fn samples_follow_the_density() {
        ChiSquare::default().sphere(|random| Some(sample(random.next_vec2())), pdf).assert();
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        assert_round_trip(sample, invert, 1e-6);
    }
}
