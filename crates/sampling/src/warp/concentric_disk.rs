//! The unit disk by the concentric map, which preserves areas and neighbourhoods.
//!
//! Shirley and Chiu, *A Low Distortion Map Between Disk and Square*, 1997.

use crate::hash::ONE_MINUS_EPSILON;
use etendue_math::lanes::{Real, Vector2};
use glam::Vec2;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4};

/// A uniform point of the unit disk.
#[inline]
#[must_use]
pub fn sample(uniform: Vec2) -> Vec2 {
    sample_lanes::<f32>(uniform.into()).into()
}

/// [`sample`] over any [`Real`].
#[inline(always)]
#[must_use]
pub fn sample_lanes<R: Real>(uniform: Vector2<R>) -> Vector2<R> {
    let (x, y) = (uniform.x * 2.0 - 1.0, uniform.y * 2.0 - 1.0);
    // Without branches: the processor cannot predict which coordinate is greater.
    let across = x.abs().gt(y.abs());
    let (radius, minor) = (R::select(across, x, y), R::select(across, y, x));
    let divisor = R::select(radius.equals(radius.zero()), radius.like(1.0), radius);
    let (sine, cosine) = (minor / divisor * FRAC_PI_4).sin_cos_eighth();
    let (along, aside) = (radius * cosine, radius * sine);
    Vector2::new(R::select(across, along, aside), R::select(across, aside, along))
}

/// The density per area: 1/π inside the unit disk.
#[inline]
#[must_use]
pub fn pdf(point: Vec2) -> f32 {
    // The rim is wider by the rounding error of `sample`, so that every sample has a density.
    if point.length_squared() <= 1.0 + 4.0 * f32::EPSILON { FRAC_1_PI } else { 0.0 }
}

/// The uniform numbers that [`sample`] maps to a point of the unit disk.
#[inline]
#[must_use]
pub fn invert(point: Vec2) -> Vec2 {
    let radius = point.length();
    let centred = if point.x.abs() > point.y.abs() {
        Vec2::new(1.0, (point.y / point.x).atan() / FRAC_PI_4) * radius.copysign(point.x)
    } else if point.y != 0.0 {
        Vec2::new((point.x / point.y).atan() / FRAC_PI_4, 1.0) * radius.copysign(point.y)
    } else {
        Vec2::ZERO
    };
    (0.5 * centred + 0.5).clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::test_support::assert_round_trip;
    use etendue_testkit::ChiSquare;

    #[test]
    fn samples_follow_the_density() {
        let bounds = (Vec2::splat(-1.001), Vec2::splat(1.001));
        ChiSquare::default().plane(bounds, |random| Some(sample(random.next_vec2())), pdf).assert();
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        assert_round_trip(sample, invert, 1e-6);
        assert_eq!(invert(Vec2::ZERO), Vec2::splat(0.5));
    }
}
