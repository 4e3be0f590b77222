//! Directions uniform over the whole sphere.

use super::uniform_cone;
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// A uniform direction. The rim of the square maps to −z.
#[inline]
#[must_use]
pub fn sample(uniform: Vec2) -> Vec3 {
    uniform_cone::sample(uniform, 2.0)
}

/// The density per solid angle, 1/4π.
#[inline]
#[must_use]
pub fn pdf(_direction: Vec3) -> f32 {
    0.25 * FRAC_1_PI
}

/// The uniform numbers behind a direction.
#[inline]
#[must_use]
pub fn invert(direction: Vec3) -> Vec2 {
    uniform_cone::invert(direction, 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_testkit::{ChiSquare, TestRng};

    #[test]
    fn samples_follow_the_density() {
        ChiSquare::default().sphere(|random| Some(sample(random.next_vec2())), pdf).assert();
    }

    #[test]
    fn the_map_undoes_the_inverse() {
        // In this order, as near −z a small turn is a large way along the rim of the square.
        let mut random = TestRng::new(4);
        for _ in 0..20_000 {
            let direction = random.unit_vector();
            // 1 − z = 2r², and four roundings of r move it by 2·10⁻⁶ at most; the angle is worse by
            // one over the sine.
            let sine = direction.truncate().length();
            let error = sample(invert(direction)).distance(direction);
            assert!(error < 2e-6 / sine.max(1e-3), "{direction}: {error}");
        }
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_Z] {
            assert!(sample(invert(axis)).distance(axis) < 2e-3);
        }
    }
}
