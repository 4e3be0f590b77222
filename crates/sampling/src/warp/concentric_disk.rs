//! The unit disk, by the concentric map, which keeps areas and neighbours.
//!
//! Shirley and Chiu, *A Low Distortion Map Between Disk and Square*, 1997.

use crate::hash::ONE_MINUS_EPSILON;
use glam::Vec2;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4};

/// A uniform point of the unit disk.
#[inline]
#[must_use]
pub fn sample(uniform: Vec2) -> Vec2 {
    let centred = 2.0 * uniform - Vec2::ONE;
    // Without branches: which coordinate is the greater cannot be foretold.
    let across = centred.x.abs() > centred.y.abs();
    let (radius, minor) = if across { (centred.x, centred.y) } else { (centred.y, centred.x) };
    let angle = FRAC_PI_4 * (minor / if radius == 0.0 { 1.0 } else { radius });
    let (sine, cosine) = sin_cos_eighth(angle);
    radius * if across { Vec2::new(cosine, sine) } else { Vec2::new(sine, cosine) }
}

/// Sine and cosine of an angle between −π/4 and π/4, to within two roundings: their Taylor series,
/// whose next terms are below 3·10⁻⁹ there. The library's take any angle, and a call.
#[inline]
fn sin_cos_eighth(angle: f32) -> (f32, f32) {
    let square = angle * angle;
    let sine = 1.0 / 362_880.0;
    let sine = sine * square - 1.0 / 5040.0;
    let sine = sine * square + 1.0 / 120.0;
    let sine = sine * square - 1.0 / 6.0;
    let cosine = -1.0 / 3_628_800.0;
    let cosine = cosine * square + 1.0 / 40_320.0;
    let cosine = cosine * square - 1.0 / 720.0;
    let cosine = cosine * square + 1.0 / 24.0;
    let cosine = cosine * square - 0.5;
    (angle + angle * (square * sine), 1.0 + square * cosine)
}

/// The density per area: 1/π inside the unit disk.
#[inline]
#[must_use]
pub fn pdf(point: Vec2) -> f32 {
    // The rim is widened by the rounding of `sample`, so that every sample has a density.
    if point.length_squared() <= 1.0 + 4.0 * f32::EPSILON { FRAC_1_PI } else { 0.0 }
}

/// The uniform numbers behind a point of the unit disk.
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
    fn sine_and_cosine_are_good_to_two_roundings() {
        for step in -1000_i16..=1000 {
            let angle = FRAC_PI_4 * f32::from(step) / 1000.0;
            let (sine, cosine) = sin_cos_eighth(angle);
            let (true_sine, true_cosine) = f64::from(angle).sin_cos();
            assert!((f64::from(sine) - true_sine).abs() <= 1.2e-7, "{angle}");
            assert!((f64::from(cosine) - true_cosine).abs() <= 1.2e-7, "{angle}");
        }
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        assert_round_trip(sample, invert, 1e-6);
        assert_eq!(invert(Vec2::ZERO), Vec2::splat(0.5));
    }
}
