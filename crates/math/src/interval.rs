//! Closed `f64` intervals with outward rounding: the result of an operation contains every exact
//! result.

use std::ops::{Add, Mul, Neg, Sub};

/// The numbers from `low` to `high`, inclusive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower bound.
    pub low: f64,
    /// The upper bound.
    pub high: f64,
}

impl Interval {
    /// The interval between two numbers, in either order.
    #[must_use]
    pub fn new(a: f64, b: f64) -> Self {
        Self { low: a.min(b), high: a.max(b) }
    }

    /// The interval of one number.
    #[must_use]
    pub fn point(x: f64) -> Self {
        Self { low: x, high: x }
    }

    /// Whether `x` is inside or on the boundary.
    #[must_use]
    pub fn contains(&self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// The width.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.high - self.low
    }

    /// The midpoint.
    #[must_use]
    pub fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// The squares of the numbers inside.
    #[must_use]
    pub fn square(self) -> Self {
        let (a, b) = (self.low * self.low, self.high * self.high);
        let low = if self.contains(0.0) { 0.0 } else { a.min(b) };
        outwards(low, a.max(b))
    }
}

/// An interval, widened by one representable number at each end.
fn outwards(low: f64, high: f64) -> Interval {
    Interval { low: low.next_down(), high: high.next_up() }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        outwards(self.low + other.low, self.high + other.high)
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        outwards(self.low - other.high, self.high - other.low)
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let products = [
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ];
        outwards(
            products.into_iter().fold(f64::INFINITY, f64::min),
            products.into_iter().fold(f64::NEG_INFINITY, f64::max),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_contain_the_exact_values() {
        let (a, b) = (Interval::new(-1.5, 2.0), Interval::new(0.25, 0.75));
        for x in [-1.5, -0.1, 0.0, 1.3, 2.0] {
            for y in [0.25, 0.5, 0.75] {
                assert!((a + b).contains(x + y));
                assert!((a - b).contains(x - y));
                assert!((a * b).contains(x * y));
                assert!(a.square().contains(x * x));
            }
        }
        assert!(a.square().low <= 0.0 && a.square().high < 4.0001);
    }
}
