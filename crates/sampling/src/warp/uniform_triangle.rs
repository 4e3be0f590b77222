//! Points uniform in a triangle, as barycentric coordinates.
//!
//! Heitz, *A Low-Distortion Map Between Triangle and Square*, 2019: the square is folded along its
//! diagonal. Unlike the square-root map, it does not crowd samples at a vertex.

use crate::hash::ONE_MINUS_EPSILON;
use etendue_math::lanes::{Real, Vector2};
use glam::Vec2;

/// The barycentric coordinates of two vertices, both ≥ 0 with a sum ≤ 1; the third is the rest.
#[inline]
#[must_use]
pub fn sample(uniform: Vec2) -> Vec2 {
    sample_lanes::<f32>(uniform.into()).into()
}

/// [`sample`] over any [`Real`].
#[inline(always)]
#[must_use]
pub fn sample_lanes<R: Real>(uniform: Vector2<R>) -> Vector2<R> {
    let Vector2 { x, y } = uniform;
    let above = y.gt(x);
    let half = R::select(above, x, y) * 0.5;
    Vector2::new(R::select(above, half, x - half), R::select(above, y - half, half))
}

/// The density in the plane of the two coordinates: 2 inside. (Per area: one over the triangle's.)
#[inline]
#[must_use]
pub fn pdf(coordinates: Vec2) -> f32 {
    let inside = coordinates.min_element() >= 0.0 && coordinates.element_sum() <= 1.0;
    if inside { 2.0 } else { 0.0 }
}

/// The uniform numbers that [`sample`] maps to barycentric coordinates.
#[inline]
#[must_use]
pub fn invert(coordinates: Vec2) -> Vec2 {
    let uniform = if coordinates.y > coordinates.x {
        Vec2::new(2.0 * coordinates.x, coordinates.x + coordinates.y)
    } else {
        Vec2::new(coordinates.x + coordinates.y, 2.0 * coordinates.y)
    };
    uniform.clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::test_support::assert_round_trip;
    use etendue_testkit::ChiSquare;

    #[test]
    fn samples_follow_the_density() {
        ChiSquare::default().square(|random| Some(sample(random.next_vec2())), pdf).assert();
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        assert_round_trip(sample, invert, 1e-6);
    }
}
