//! The placement of a closure in the shading frame of its hit.

use etendue_math::Frame;
use glam::Vec3;

/// The placement of a closure in the shading frame of its hit, and its weight.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// The closure's fraction of the total. The weights of all closures of a hit sum to at most
    /// one.
    pub weight: f32,
    /// The rows of the matrix from shading coordinates to the closure's, if a bump or normal map
    /// has turned it; applied before `flipped`. It may contain a reflection.
    pub(crate) turned: Option<Frame>,
    /// Whether the closure is flipped, with its z axis reversed.
    pub(crate) flipped: bool,
    /// How strongly light fades out towards the horizon of the shading frame if a bump or normal
    /// map has turned the closure: a squared roughness. Zero for no fading.
    pub(crate) shadowing: f32,
}

impl Placement {
    /// A single closure with full weight in the shading frame.
    pub const PLAIN: Self = Self { weight: 1.0, turned: None, flipped: false, shadowing: 0.0 };

    /// The same placement with its weight multiplied.
    #[must_use]
    pub fn scaled(self, share: f32) -> Self {
        Self { weight: self.weight * share, ..self }
    }

    /// The same placement, flipped.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { flipped: !self.flipped, ..self }
    }

    /// The placement turned to `frame`, which is given in this placement's coordinates.
    #[must_use]
    pub fn turned(self, frame: Frame) -> Self {
        // Rows of the product: local axes of `frame`, transformed back to shading coordinates.
        let back = |axis: Vec3| {
            let axis = if self.flipped { flip(axis) } else { axis };
            self.turned.map_or(axis, |turned| turned.to_world(axis))
        };
        let turned = Frame { s: back(frame.s), t: back(frame.t), n: back(frame.n) };
        Self { turned: Some(turned), flipped: false, ..self }
    }

    /// The placement with light fading out towards the horizon, as shadowed by bumps with the given
    /// `normal`. The normal is in this placement's coordinates before turning.
    /// Estevez et al., "A Microfacet-Based Shadowing Function to Solve the Bump Terminator
    /// Problem", *Ray Tracing Gems*, 2019, chapter 12.
    /// *Ray Tracing Gems*, 2019, chapter 12.
    #[must_use]
    pub fn shadowed(self, normal: Vec3) -> Self {
        let cos2 = normal.z * normal.z;
        let tan2 = normal.truncate().length_squared() / cos2.max(f32::MIN_POSITIVE);
        // For nested maps the steeper one counts. They are rare, and the exact product is rarely
        // visible.
        Self { shadowing: self.shadowing.max((0.125 * tan2).min(1.0)), ..self }
    }

    /// The factor by which bumps shadow the shading direction `wo`.
    #[inline]
    pub(crate) fn shadow(&self, wo: Vec3) -> f32 {
        if self.shadowing == 0.0 {
            return 1.0;
        }
        let tan2 = wo.truncate().length_squared() / (wo.z * wo.z);
        2.0 / (1.0 + (1.0 + self.shadowing * tan2).sqrt())
    }

    /// The frame that bump and normal maps have turned this placement to, in shading coordinates.
    /// Flipping does not change it: a map means the same on both sides of a surface.
    #[must_use]
    pub fn frame(&self) -> Frame {
        self.turned.unwrap_or(Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z })
    }

    /// Transforms shading coordinates to the closure's.
    #[inline]
    #[must_use]
    pub fn to_closure(&self, v: Vec3) -> Vec3 {
        let v = self.turned.map_or(v, |turned| turned.to_local(v));
        if self.flipped { flip(v) } else { v }
    }

    /// Transforms the closure's coordinates to shading coordinates.
    #[inline]
    pub(crate) fn to_shading(self, v: Vec3) -> Vec3 {
        let v = if self.flipped { flip(v) } else { v };
        self.turned.map_or(v, |turned| turned.to_world(v))
    }

    /// Whether a direction lies on the same side of the turned surface as of the original one.
    /// Other directions would leak light through the surface and are cut off.
    #[inline]
    pub(crate) fn agrees(&self, shading: Vec3, closure: Vec3) -> bool {
        let Some(turned) = self.turned else { return true };
        // A reflection in the matrix, or flipping, swaps the sides.
        let reflected = turned.s.cross(turned.t).dot(turned.n) < 0.0;
        let side = if reflected != self.flipped { -1.0 } else { 1.0 };
        shading.z * closure.z * side > 0.0
    }
}

#[inline]
pub(crate) fn flip(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.y, -v.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted() -> Frame {
        Frame::from_normal(Vec3::new(0.3, -0.2, 0.9).normalize())
    }

    #[test]
    fn a_placement_takes_directions_there_and_back() {
        let v = Vec3::new(0.1, 0.5, -0.7).normalize();
        let places = [
            Placement::PLAIN,
            Placement::PLAIN.flipped(),
            Placement::PLAIN.turned(tilted()).flipped(),
            Placement::PLAIN.flipped().turned(tilted()),
            Placement::PLAIN.turned(tilted()).flipped().turned(tilted()),
        ];
        for place in places {
            assert!((place.to_shading(place.to_closure(v)) - v).length() < 1e-6, "{place:?}");
        }
    }

    #[test]
    fn turning_follows_what_was_done_before() {
        let v = Vec3::new(0.1, 0.5, -0.7).normalize();
        let place = Placement::PLAIN.flipped().turned(tilted());
        assert!((place.to_closure(v) - tilted().to_local(flip(v))).length() < 1e-6);
        let place = Placement::PLAIN.turned(tilted()).flipped();
        assert!((place.to_closure(v) - flip(tilted().to_local(v))).length() < 1e-6);
    }

    #[test]
    fn sides_agree_for_steep_directions_however_the_closure_lies() {
        for place in [
            Placement::PLAIN.turned(tilted()),
            Placement::PLAIN.flipped().turned(tilted()),
            Placement::PLAIN.turned(tilted()).flipped(),
        ] {
            for v in [Vec3::Z, -Vec3::Z] {
                assert!(place.agrees(v, place.to_closure(v)), "{place:?} {v}");
            }
        }
    }

    #[test]
    fn bumps_shadow_grazing_light_most() {
        let place = Placement::PLAIN.shadowed(Vec3::new(0.6, 0.0, 0.8));
        let factor = |z: f32| place.shadow(Vec3::new((1.0 - z * z).sqrt(), 0.0, z));
        assert_eq!(factor(1.0), 1.0);
        assert_eq!(factor(0.0), 0.0);
        assert!(factor(0.5) < factor(0.8));
        assert_eq!(Placement::PLAIN.shadow(Vec3::X), 1.0);
    }
}
