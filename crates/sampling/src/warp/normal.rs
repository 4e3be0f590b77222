//! The standard normal distribution of the plane (Box and Muller, 1958).

use crate::hash::ONE_MINUS_EPSILON;
use glam::Vec2;
use std::f32::consts::TAU;

/// A point whose two coordinates are independent standard normal numbers. Scale it by the standard
/// deviation. The greatest length is √(48 ln 2) ≈ 5.8, as uniform numbers have 24 bits.
#[inline]
#[must_use]
pub fn sample(uniform: Vec2) -> Vec2 {
    let radius = (-2.0 * (-uniform.x).ln_1p()).sqrt();
    let (sine, cosine) = (TAU * uniform.y).sin_cos();
    radius * Vec2::new(cosine, sine)
}

/// The density per area.
#[inline]
#[must_use]
pub fn pdf(point: Vec2) -> f32 {
    (-0.5 * point.length_squared()).exp() / TAU
}

/// The uniform numbers that [`sample`] maps to a point.
#[inline]
#[must_use]
pub fn invert(point: Vec2) -> Vec2 {
    let share = -(-0.5 * point.length_squared()).exp_m1();
    let turns = point.y.atan2(point.x) / TAU;
    let turns = if turns < 0.0 { turns + 1.0 } else { turns };
    Vec2::new(share, turns).min(Vec2::splat(ONE_MINUS_EPSILON))
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::{ChiSquare, TestRng};

    #[test]
    fn samples_follow_the_density() {
        let bounds = (Vec2::splat(-6.0), Vec2::splat(6.0));
        ChiSquare::default().plane(bounds, |random| Some(sample(random.next_vec2())), pdf).assert();
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        let mut random = TestRng::new(5);
        for _ in 0..20_000 {
            let uniform = random.next_vec2();
            let difference = (invert(sample(uniform)) - uniform).abs();
            // Near the centre and across the cut, the angle is arbitrary.
            let turn = difference.y.min(1.0 - difference.y);
            assert!(difference.x < 1e-6 && turn < 1e-6, "{uniform} {difference}");
        }
    }
}
