//! Directions uniform over the whole sphere.

use super::uniform_cone;
use etendue_math::lanes::{Real, Vector2, Vector3};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// 1 − cos of the half angle of the cone that contains all directions.
const WHOLE: f32 = 2.0;

/// A uniform direction. The rim of the square maps to −z.
#[inline]
#[must_use]
pub fn sample(uniform: Vec2) -> Vec3 {
    uniform_cone::sample(uniform, WHOLE)
}

/// [`sample`] over any [`Real`].
#[inline(always)]
#[must_use]
pub fn sample_lanes<R: Real>(uniform: Vector2<R>) -> Vector3<R> {
    uniform_cone::sample_lanes(uniform, uniform.x.like(WHOLE))
}

/// The density per solid angle, 1/4π.
#[inline]
#[must_use]
pub fn pdf(_direction: Vec3) -> f32 {
    0.25 * FRAC_1_PI
}

/// The uniform numbers that [`sample`] maps to a direction.
#[inline]
#[must_use]
pub fn invert(direction: Vec3) -> Vec2 {
    uniform_cone::invert(direction, WHOLE)
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
        // In this order, because near −z a small turn is a long way along the rim of the square.
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
