//! Axis-aligned boxes.

use glam::Vec3;

/// An axis-aligned box that includes its boundary. [`Bounds3::EMPTY`] contains no point and is the
/// neutral element of [`Bounds3::union`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds3 {
    /// The minimum corner.
    pub min: Vec3,
    /// The maximum corner.
    pub max: Vec3,
}

impl Bounds3 {
    /// The empty box.
    pub const EMPTY: Self =
        Self { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) };

    /// The box with these corners.
    #[must_use]
    pub fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The smallest box around `points`.
    #[must_use]
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with_point)
    }

    /// Whether the box contains no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// The smallest box around this one and `point`.
    #[inline]
    #[must_use]
    pub fn with_point(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around both.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The points that are in both boxes.
    #[inline]
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Whether `point` is inside or on the boundary.
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// The edge lengths; at least one is negative if the box is empty.
    #[inline]
    #[must_use]
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// The centre.
    #[inline]
    #[must_use]
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Half the surface area; zero for the empty box.
    #[inline]
    #[must_use]
    pub fn half_area(&self) -> f32 {
        let extent = self.extent().max(Vec3::ZERO);
        extent.x * extent.y + extent.y * extent.z + extent.z * extent.x
    }

    /// The centre and radius of the smallest sphere around the box; the origin and zero if it is
    /// empty.
    #[must_use]
    pub fn bounding_sphere(&self) -> (Vec3, f32) {
        if self.is_empty() {
            return (Vec3::ZERO, 0.0);
        }
        (self.center(), (self.max - self.center()).length())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_empty_box_is_neutral_and_has_no_area() {
        let unit = Bounds3::new(Vec3::ZERO, Vec3::ONE);
        assert_eq!(Bounds3::EMPTY.union(unit), unit);
        assert!(Bounds3::EMPTY.is_empty() && !unit.is_empty());
        assert_eq!(Bounds3::EMPTY.half_area(), 0.0);
        assert_eq!(unit.half_area(), 3.0);
    }

    #[test]
    fn the_bounding_sphere_touches_the_corners() {
        let (center, radius) = Bounds3::new(Vec3::ZERO, Vec3::ONE).bounding_sphere();
        assert_eq!(center, Vec3::splat(0.5));
        assert!((radius - 0.75_f32.sqrt()).abs() < 1e-6);
    }
}
