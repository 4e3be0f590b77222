//! Directions with density proportional to the cosine (Malley's method: a disk lifted to the
//! hemisphere; Pharr, Jakob and Humphreys, *Physically Based Rendering*, 4th edition, A.5.3).

use super::concentric_disk;
use etendue_math::lanes::{Real, Vector2, Vector3};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// A direction above the horizon, with density cosθ/π.
#[inline]
#[must_use]
pub fn sample(uniform: Vec2) -> Vec3 {
    sample_lanes::<f32>(uniform.into()).into()
}

/// [`sample`] over any [`Real`].
#[inline(always)]
#[must_use]
pub fn sample_lanes<R: Real>(uniform: Vector2<R>) -> Vector3<R> {
    let disk = concentric_disk::sample_lanes(uniform);
    // Directions at the horizon have zero density; rounding must not produce one.
    let z = (-disk.length_squared() + 1.0).safe_sqrt();
    disk.extend(z.max(z.like(1e-6)))
}

/// The density per solid angle: cosθ/π above the horizon.
#[inline]
#[must_use]
pub fn pdf(direction: Vec3) -> f32 {
    pdf_lanes::<f32>(direction.into())
}

/// [`pdf`] over any [`Real`].
#[inline(always)]
#[must_use]
pub fn pdf_lanes<R: Real>(direction: Vector3<R>) -> R {
    direction.z.max(direction.z.zero()) * FRAC_1_PI
}

/// The uniform numbers that [`sample`] maps to a direction above the horizon.
#[inline]
#[must_use]
pub fn invert(direction: Vec3) -> Vec2 {
    concentric_disk::invert(direction.truncate())
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

    #[test]
    fn corners_stay_above_the_horizon() {
        for corner in [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE].map(|c| c * 0.999_999_94) {
            let direction = sample(corner);
            assert!(pdf(direction) > 0.0 && (direction.length() - 1.0).abs() < 1e-6);
        }
    }
}
