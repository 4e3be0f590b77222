//! Orthonormal frames.

use crate::lanes::Frame3;
use glam::Vec3;

/// Two unit vectors that complete the unit vector `n` to a right-handed orthonormal basis; see
/// [`Frame3::from_normal`].
#[inline(always)]
#[must_use]
pub fn coordinate_system(n: Vec3) -> (Vec3, Vec3) {
    let frame = Frame3::<f32>::from_normal(n.into());
    (frame.s.into(), frame.t.into())
}

/// A right-handed orthonormal basis: tangent `s`, bitangent `t`, normal `n`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The local x axis.
    pub s: Vec3,
    /// The local y axis.
    pub t: Vec3,
    /// The local z axis, the normal.
    pub n: Vec3,
}

impl Frame {
    /// A frame with the unit normal `n` and an arbitrary tangent.
    #[inline(always)]
    #[must_use]
    pub fn from_normal(n: Vec3) -> Self {
        let (s, t) = coordinate_system(n);
        Self { s, t, n }
    }

    /// The frame with the unit normal `n` whose `s` is as close to `tangent` as possible. The
    /// tangent is arbitrary if `tangent` is zero, not finite, or parallel to the normal.
    #[inline(always)]
    #[must_use]
    pub fn from_normal_and_tangent(n: Vec3, tangent: Vec3) -> Self {
        let frame = Frame3::<f32>::from_normal_and_tangent(n.into(), tangent.into());
        Self { s: frame.s.into(), t: frame.t.into(), n }
    }

    /// Transforms from world to local coordinates.
    #[inline(always)]
    #[must_use]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.s.dot(v), self.t.dot(v), self.n.dot(v))
    }

    /// Transforms from local to world coordinates.
    #[inline(always)]
    #[must_use]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_orthonormal(frame: Frame) {
        for (a, b) in [(frame.s, frame.t), (frame.t, frame.n), (frame.n, frame.s)] {
            assert!(a.dot(b).abs() < 1e-6, "{frame:?}");
        }
        for axis in [frame.s, frame.t, frame.n] {
            assert!((axis.length() - 1.0).abs() < 1e-6, "{frame:?}");
        }
        assert!(frame.s.cross(frame.t).dot(frame.n) > 0.999, "left-handed: {frame:?}");
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed_also_at_the_poles() {
        for n in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(1e-6, -1e-6, -1.0), Vec3::ONE] {
            assert_orthonormal(Frame::from_normal(n.normalize()));
        }
    }

    #[test]
    fn a_tangent_along_the_normal_still_gives_a_frame() {
        for tangent in [Vec3::ZERO, Vec3::Z * 3.0, Vec3::splat(f32::NAN), Vec3::new(0.1, 0.0, 5.0)]
        {
            assert_orthonormal(Frame::from_normal_and_tangent(Vec3::Z, tangent));
        }
        assert_eq!(Frame::from_normal_and_tangent(Vec3::Z, Vec3::new(2.0, 0.0, 5.0)).s, Vec3::X);
    }

    #[test]
    fn local_and_world_are_inverse() {
        let frame = Frame::from_normal(Vec3::new(0.48, -0.6, 0.64));
        let v = Vec3::new(0.3, -2.0, 0.7);
        assert!((frame.to_world(frame.to_local(v)) - v).length() < 1e-6);
    }
}
