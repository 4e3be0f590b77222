//! What the tests need of a ray, computed once per ray.

use crate::error_bounds::{LEAST_DIRECTION, PADDING};
use crate::simd::Simd;
use etendue_math::Ray;

/// The constants of the triangle test.
#[derive(Clone, Copy)]
pub(crate) struct RayConstants {
    /// The origin.
    pub(crate) origin: [f32; 3],
    /// The two minor axes, then that of the direction's greatest component.
    pub(crate) axes: [usize; 3],
    /// The direction's slope along the minor axes, then one over its greatest component.
    pub(crate) shear: [f32; 3],
}

/// The constants of the box test, in all lanes.
pub(crate) struct BoxConstants<S: Simd> {
    inverse: [S::Vector; 3],
    near_offset: [S::Vector; 3],
    far_offset: [S::Vector; 3],
    /// Which of a node's six planes is met first on each axis.
    near_plane: [usize; 3],
}

impl RayConstants {
    /// `None` for a ray that hits nothing: with a coordinate that is not finite, or a direction
    /// without a normal number in it.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Option<Self> {
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let size = ray.direction.abs();
        let z = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let usable = ray.direction.is_finite()
            && size[z] >= f32::MIN_POSITIVE
            && ray.origin.is_finite()
            && ray.t_max > 0.0;
        let shear = [
            direction[axes[0]] / direction[z],
            direction[axes[1]] / direction[z],
            1.0 / direction[z],
        ];
        usable.then_some(Self { origin, axes, shear })
    }
}

impl<S: Simd> BoxConstants<S> {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        let least = ray.direction.abs().max_element() * LEAST_DIRECTION;
        let padding = ray.origin.abs().max_element() * PADDING;
        let inverse = ray.direction.to_array().map(|d| 1.0 / d.abs().max(least).copysign(d));
        let offset = |sign: f32| {
            [0, 1, 2].map(|axis| {
                let inverse = inverse[axis];
                S::splat(-ray.origin[axis] * inverse + sign * padding * inverse.abs())
            })
        };
        Self {
            near_offset: offset(-1.0),
            far_offset: offset(1.0),
            near_plane: [0, 1, 2].map(|axis| 2 * axis + usize::from(inverse[axis] < 0.0)),
            inverse: inverse.map(S::splat),
        }
    }

    /// Which children's boxes the ray meets before `t_max`, and where it enters them.
    #[inline(always)]
    pub(crate) fn meet(&self, node: &crate::node::Node, t_max: S::Vector) -> (u32, S::Vector) {
        let plane = |axis: usize, side: usize, offset: S::Vector| {
            let plane = self.near_plane[axis] ^ side;
            // SAFETY: near_plane is 2·axis or 2·axis + 1, and its neighbour by the lowest bit is
            // the other one, so all are below 6.
            let planes = unsafe { node.planes.get_unchecked(plane) };
            S::multiply_add(S::load(planes), self.inverse[axis], offset)
        };
        let near = |axis: usize| plane(axis, 0, self.near_offset[axis]);
        let far = |axis: usize| plane(axis, 1, self.far_offset[axis]);
        // A distance that is not a number (coordinates near the end of the range) does not bound:
        // the second operands are never NaN.
        let enter = S::greatest(S::greatest(near(0), near(1)), S::greatest(near(2), S::splat(0.0)));
        let leave = S::least(S::least(far(0), far(1)), S::least(far(2), t_max));
        (S::less_equal(enter, leave), enter)
    }
}
