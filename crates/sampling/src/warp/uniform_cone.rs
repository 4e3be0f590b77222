//! Directions uniform in a cone about +z, given by 1 − cos of its half angle.
//!
//! The parameter is this difference because the cosine of a small angle loses all precision in `f32`
//! (the sun's half angle of 0.27° has 1 − cosθ = 1.1·10⁻⁵).

use super::concentric_disk;
use etendue_math::lanes::{Real, Vector2, Vector3};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// 1 − cos of `angle` (radians), accurate however small the angle is.
#[inline]
#[must_use]
pub fn one_minus_cosine(angle: f32) -> f32 {
    let sine = (0.5 * angle).sin();
    2.0 * sine * sine
}

/// A uniform direction in the cone; `one_minus_cosine` in (0, 2] is the cone's 1 − cosθ.
///
/// An area-preserving map of the disk to the cap: r² is the share of 1 − cosθ.
#[inline]
#[must_use]
pub fn sample(uniform: Vec2, one_minus_cosine: f32) -> Vec3 {
    sample_lanes(uniform.into(), one_minus_cosine).into()
}

/// [`sample`] over any [`Real`].
#[inline(always)]
#[must_use]
pub fn sample_lanes<R: Real>(uniform: Vector2<R>, one_minus_cosine: R) -> Vector3<R> {
    let disk = concentric_disk::sample_lanes(uniform);
    let height = disk.length_squared().min(one_minus_cosine.like(1.0)) * one_minus_cosine;
    let scale = (one_minus_cosine * (-height + 2.0)).safe_sqrt();
    (disk * scale).extend(-height + 1.0)
}

/// The density per solid angle: the cone's solid angle is 2π(1 − cosθ).
#[inline]
#[must_use]
pub fn pdf(direction: Vec3, one_minus_cosine: f32) -> f32 {
    // The rim is wider by the rounding error of `sample`, so that every sample has a density.
    let rim = one_minus_cosine * (1.0 + 8.0 * f32::EPSILON) + 4.0 * rounding(one_minus_cosine);
    if height(direction) <= rim { 0.5 * FRAC_1_PI / one_minus_cosine } else { 0.0 }
}

/// The uniform numbers that [`sample`] maps to a direction of the cone.
#[inline]
#[must_use]
pub fn invert(direction: Vec3, one_minus_cosine: f32) -> Vec2 {
    let radius = (height(direction) / one_minus_cosine).clamp(0.0, 1.0).sqrt();
    let planar = direction.truncate();
    let length = planar.length();
    // On the axis and opposite to it, the azimuth is arbitrary.
    concentric_disk::invert(if length > 0.0 {
        planar * (radius / length)
    } else {
        Vec2::X * radius
    })
}

/// 1 − cos of the direction's angle to +z, without cancellation.
#[inline]
fn height(direction: Vec3) -> f32 {
    if direction.z > 0.0 {
        direction.truncate().length_squared() / (1.0 + direction.z)
    } else {
        1.0 - direction.z
    }
}

/// The absolute rounding error of a unit vector, which matters only below the equator.
#[inline]
fn rounding(one_minus_cosine: f32) -> f32 {
    if one_minus_cosine < 1.0 { 0.0 } else { f32::EPSILON }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::test_support::assert_round_trip;
    use etendue_testkit::{ChiSquare, z_test};

    const ANGLES: [f32; 5] = [1e-4, 0.004_7, 0.3, 1.6, 3.0];

    #[test]
    fn samples_follow_the_density() {
        for angle in ANGLES {
            let cap = one_minus_cosine(angle);
            ChiSquare::one_of(5)
                .sphere(|random| Some(sample(random.next_vec2(), cap)), |w| pdf(w, cap))
                .assert();
        }
    }

    #[test]
    fn small_cones_are_evenly_filled() {
        // In a small cone, x²+y² is uniform up to the squared sine of the half angle.
        for angle in [1e-6_f32, 1e-3] {
            let cap = one_minus_cosine(angle);
            assert!((cap / (0.5 * angle * angle) - 1.0).abs() < 1e-6);
            let mut random = etendue_testkit::TestRng::new(3);
            let shares = (0..100_000).map(|_| {
                let direction = sample(random.next_vec2(), cap);
                f64::from(direction.truncate().length_squared() / (angle * angle))
            });
            assert!(z_test(&shares.collect(), 0.5, 1.0 / 12.0).accepts(1e-3));
        }
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        for angle in [1e-4, 0.004_7, 0.3, 1.6] {
            let cap = one_minus_cosine(angle);
            assert_round_trip(|u| sample(u, cap), |w| invert(w, cap), 1e-5);
        }
    }
}
