//! A density on the unit square that interpolates four corners bilinearly.
//!
//! *Physically Based Rendering*, 4th edition, A.5.6: a linear marginal, then a linear conditional.

use super::linear;
use glam::Vec2;

/// The weights (≥ 0) at the corners of the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corners {
    /// At (0, 0) and (1, 0).
    pub lower: Vec2,
    /// At (0, 1) and (1, 1).
    pub upper: Vec2,
}

impl Corners {
    /// The weights at the left and right end of the horizontal line at height `y`.
    #[inline]
    fn row(&self, y: f32) -> Vec2 {
        self.lower.lerp(self.upper, y)
    }
}

/// A point of [0, 1)².
#[inline]
#[must_use]
pub fn sample(uniform: Vec2, corners: &Corners) -> Vec2 {
    let (low, high) = (corners.lower.element_sum(), corners.upper.element_sum());
    let y = linear::sample(uniform.y, low, high);
    let row = corners.row(y);
    Vec2::new(linear::sample(uniform.x, row.x, row.y), y)
}

/// The density per area; uniform where all corners are zero.
#[inline]
#[must_use]
pub fn pdf(point: Vec2, corners: &Corners) -> f32 {
    let (low, high) = (corners.lower.element_sum(), corners.upper.element_sum());
    let row = corners.row(point.y);
    linear::pdf(point.y, low, high) * linear::pdf(point.x, row.x, row.y)
}

/// The uniform numbers that [`sample`] maps to a point.
#[inline]
#[must_use]
pub fn invert(point: Vec2, corners: &Corners) -> Vec2 {
    let (low, high) = (corners.lower.element_sum(), corners.upper.element_sum());
    let row = corners.row(point.y);
    Vec2::new(linear::invert(point.x, row.x, row.y), linear::invert(point.y, low, high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::test_support::assert_round_trip;
    use etendue_testkit::ChiSquare;

    const CASES: [Corners; 3] = [
        Corners { lower: Vec2::new(0.1, 2.0), upper: Vec2::new(3.0, 0.5) },
        Corners { lower: Vec2::new(0.0, 0.0), upper: Vec2::new(1.0, 4.0) },
        Corners { lower: Vec2::ONE, upper: Vec2::ONE },
    ];

    #[test]
    fn samples_follow_the_density() {
        for corners in &CASES {
            ChiSquare::one_of(3)
                .square(
                    |random| {
                        // The end from the number zero has no density where a corner is zero.
                        Some(sample(random.next_vec2().max(Vec2::splat(1e-7)), corners))
                    },
                    |point| pdf(point, corners),
                )
                .assert();
        }
    }

    #[test]
    fn the_inverse_undoes_the_map() {
        for corners in &CASES {
            assert_round_trip(|u| sample(u, corners), |p| invert(p, corners), 2e-6);
        }
    }
}
