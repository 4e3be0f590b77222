//! Bounds of a medium's extinction along a ray, and collisions drawn against them.
//!
//! Delta tracking (Woodcock et al., 1965) fills a medium up with imaginary matter, so that it is as
//! dense as a bound σ̄ everywhere: collisions then follow an exponential law, and one at x is real
//! with probability σt(x) / σ̄.

use crate::volume::Volume;
use etendue_math::next_up;
use etendue_math::{Bounds3, Ray};

/// Bounds of the extinction in a box.
#[derive(Clone, Debug)]
pub(super) struct Majorants {
    bounds: Bounds3,
    /// No channel is above it anywhere.
    greatest: f32,
}

/// A place where a ray meets the filled-up medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// How far along the ray, in lengths of its direction.
    pub t: f32,
    /// The bound σ̄ of the extinction there, per unit of length.
    pub majorant: f32,
}

/// Finds one collision after another along a ray.
#[derive(Clone, Debug)]
pub struct Tracker<'a> {
    majorants: &'a Majorants,
    /// Where the search goes on.
    t: f32,
    /// Where the medium ends.
    end: f32,
    /// The length of the ray's direction.
    unit: f32,
}

impl Majorants {
    /// Bounds of an extinction that is multiplied by `scale`.
    pub(super) fn new(extinction: &Volume, scale: f32) -> Self {
        Self { bounds: extinction.bounds(), greatest: extinction.range()[1] * scale }
    }

    pub(super) fn greatest(&self) -> f32 {
        self.greatest
    }

    pub(super) fn memory_bytes(&self) -> usize {
        0
    }

    #[inline]
    pub(super) fn track(&self, ray: &Ray) -> Tracker<'_> {
        let (start, end) = crossing(&self.bounds, ray);
        Tracker { majorants: self, t: start, end, unit: ray.direction.length() }
    }
}

/// Where a ray enters and leaves a box; the end is not after the start where it misses.
#[inline]
fn crossing(bounds: &Bounds3, ray: &Ray) -> (f32, f32) {
    let inverse = ray.direction.recip();
    let low = (bounds.min - ray.origin) * inverse;
    let high = (bounds.max - ray.origin) * inverse;
    // A ray within a face gives NaN on that axis, which `min` and `max` pass over.
    let (near, far) = (low.min(high), low.max(high));
    let start = near.to_array().into_iter().fold(0.0, f32::max);
    let end = far.to_array().into_iter().fold(ray.t_max, f32::min);
    (start, end)
}

impl Tracker<'_> {
    /// The next collision, `optical_depth` after the last one, which is to be drawn from the
    /// exponential distribution of rate one; `None` where the ray leaves the medium or ends before.
    #[inline]
    pub fn advance(&mut self, optical_depth: f32) -> Option<Collision> {
        let majorant = self.majorants.greatest;
        let t = self.t + optical_depth / (majorant * self.unit);
        // A step too short for single precision still leads on.
        self.t = if t > self.t { t } else { next_up(self.t) };
        // Nothing is met in a medium of density zero, where `t` is infinite or NaN.
        (self.t < self.end && majorant > 0.0).then_some(Collision { t: self.t, majorant })
    }
}
