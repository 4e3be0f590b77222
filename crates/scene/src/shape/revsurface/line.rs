//! A ray as a surface of revolution sees it.

use etendue_math::Ray;
use glam::{DAffine3, DVec3};

/// Below this sine of the angle between a line and a plane across the axis the line counts as level,
/// and below this sine of the angle to the axis as parallel to it: at the other end of the surface
/// it is off by this share of the size, less than the rounding of everything else.
const NEGLIGIBLE: f64 = 1e-14;

/// A line by what matters after everything has been turned about the y axis into one half plane: its
/// distance ρ from the axis, ρ² = `nearest_squared` + `across`·(t − `nearest`)², and its height
/// y = `height` + `rise`·(t − `nearest`), with t counted in lengths of the local space.
///
/// The hyperbola that these trace is `rise`²·(ρ² − `nearest_squared`) = `across`·(y − `height`)²:
/// nothing in it is divided by a number that may vanish.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// The point of the line that is nearest to the local origin.
    pub(super) origin: DVec3,
    /// The unit direction.
    pub(super) direction: DVec3,
    /// sin² of the angle to the axis; zero for a line that counts as parallel.
    pub(super) across: f64,
    /// cos of the angle to the axis; zero for a line that counts as level.
    pub(super) rise: f64,
    /// The square of the least distance to the axis.
    pub(super) nearest_squared: f64,
    /// Where the line is nearest to the axis.
    pub(super) nearest: f64,
    /// The height there.
    pub(super) height: f64,
    /// The ray's own start on this line.
    pub(super) start: f64,
    /// Lengths of the ray's direction for one local length.
    scale: f64,
}

impl Line {
    /// The line of `ray`; `None` if it misses the sphere around the local origin whose radius has
    /// this square, or has no direction.
    #[inline]
    pub(super) fn new(to_local: &DAffine3, ray: &Ray, radius_squared: f64) -> Option<Self> {
        let origin = to_local.transform_point3(ray.origin.as_dvec3());
        let direction = to_local.transform_vector3(ray.direction.as_dvec3());
        let length_squared = direction.length_squared();
        let along = -origin.dot(direction) / length_squared;
        // However far the ray's origin is, what follows works near the surface.
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

    /// Where the line meets the circle of the profile's point (x, y), which is known to lie on it:
    /// by the height or by the distance from the axis, whichever is less sensitive.
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

    /// How far from the nearest point the line is `beyond` farther from the axis, in squares.
    #[inline]
    pub(super) fn half_chord(&self, beyond: f64) -> f64 {
        (beyond.max(0.0) / self.across).sqrt()
    }

    /// The ray's parameter of a place on this line.
    #[inline]
    pub(super) fn ray_parameter(&self, t: f64) -> f64 {
        (t - self.start) * self.scale
    }

    /// The place on this line of a parameter of the ray.
    #[inline]
    pub(super) fn local_parameter(&self, t: f64) -> f64 {
        self.start + t / self.scale
    }

    /// The point at a place on this line.
    #[inline]
    pub(super) fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
