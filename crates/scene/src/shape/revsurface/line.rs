//! A ray in the coordinates of a surface of revolution.

use etendue_math::Ray;
use glam::{DAffine3, DVec3};

/// A line counts as level if the sine of its angle to the plane across the axis is below this, and
/// as parallel to the axis if the sine of its angle to the axis is. The resulting error at the
/// other end of the surface is this fraction of its size, which is less than the other rounding
/// errors.
const NEGLIGIBLE: f64 = 1e-14;

/// A line in the half plane into which everything is rotated about the y axis. Its distance ρ from
/// the axis satisfies ρ² = `nearest_squared` + `across`·(t − `nearest`)². Its height is
/// y = `height` + `rise`·(t − `nearest`). t is in units of local space.
///
/// Together they form the hyperbola
/// `rise`²·(ρ² − `nearest_squared`) = `across`·(y − `height`)². This form needs no division by a
/// number that may be zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// The point of the line nearest to the local origin.
    pub(super) origin: DVec3,
    /// The unit direction.
    pub(super) direction: DVec3,
    /// sin² of the angle to the axis; zero for a line that counts as parallel.
    pub(super) across: f64,
    /// cos of the angle to the axis; zero for a line that counts as level.
    pub(super) rise: f64,
    /// The squared minimum distance to the axis.
    pub(super) nearest_squared: f64,
    /// The t at which the line is nearest to the axis.
    pub(super) nearest: f64,
    /// The height there.
    pub(super) height: f64,
    /// The t of the ray's origin.
    pub(super) start: f64,
    /// The ray's parameter per unit of local length.
    scale: f64,
}

impl Line {
    /// Converts `ray`. Returns `None` if the ray has no direction, or misses the sphere around the
    /// local origin with this squared radius.
    #[inline]
    pub(super) fn new(to_local: &DAffine3, ray: &Ray, radius_squared: f64) -> Option<Self> {
        let origin = to_local.transform_point3(ray.origin.as_dvec3());
        let direction = to_local.transform_vector3(ray.direction.as_dvec3());
        let length_squared = direction.length_squared();
        let along = -origin.dot(direction) / length_squared;
        // Work near the surface, to keep precision for distant ray origins.
        let middle = origin + direction * along;
        let distance_squared = middle.length_squared();
        if distance_squared.is_nan() || distance_squared > radius_squared {
            return None;
        }
        let length = length_squared.sqrt();
        Some(Self::through(middle, direction / length, (-along * length, 1.0 / length)))
    }

    fn through(origin: DVec3, direction: DVec3, (start, scale): (f64, f64)) -> Self {
        let (px, pz, vx, vz) = (origin.x, origin.z, direction.x, direction.z);
        let across = vx * vx + vz * vz;
        let parallel = across < NEGLIGIBLE * NEGLIGIBLE;
        let cross = px * vz - pz * vx;
        let (nearest, nearest_squared) = if parallel {
            (0.0, px * px + pz * pz)
        } else {
            let inverse = 1.0 / across;
            (-(px * vx + pz * vz) * inverse, cross * cross * inverse)
        };
        let rise = if direction.y.abs() < NEGLIGIBLE { 0.0 } else { direction.y };
        Self {
            origin,
            direction,
            across: if parallel { 0.0 } else { across },
            rise,
            nearest_squared,
            nearest,
            height: origin.y + nearest * rise,
            start,
            scale,
        }
    }

    /// The t at which the line meets the circle through the profile's point (x, y). The line must
    /// meet that circle. Uses the height or the distance from the axis, whichever is better
    /// conditioned.
    #[inline]
    pub(super) fn parameter(&self, x: f64, y: f64) -> f64 {
        let beyond = x * x - self.nearest_squared;
        let rise_squared = self.rise * self.rise;
        if self.rise != 0.0 && self.across * beyond <= rise_squared * (x * x) {
            (y - self.origin.y) / self.rise
        } else {
            let half = self.half_chord(beyond);
            let before = (y - self.height) * self.rise < 0.0;
            self.nearest + if before { -half } else { half }
        }
    }

    /// The distance along the line from its nearest point at which ρ² has grown by `beyond`.
    #[inline]
    pub(super) fn half_chord(&self, beyond: f64) -> f64 {
        (beyond.max(0.0) / self.across).sqrt()
    }

    /// Converts t on this line to the ray's parameter.
    #[inline]
    pub(super) fn ray_parameter(&self, t: f64) -> f64 {
        (t - self.start) * self.scale
    }

    /// Converts the ray's parameter to t on this line.
    #[inline]
    pub(super) fn local_parameter(&self, t: f64) -> f64 {
        self.start + t / self.scale
    }

    /// The point at t on this line.
    #[inline]
    pub(super) fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
