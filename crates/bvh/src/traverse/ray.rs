//! Per-ray constants of the box and triangle tests.

use crate::error_bounds::{MIN_DIRECTION, PADDING};
use crate::node::{F32x8, Node, TriangleBlock};
use crate::simd::Simd;
use etendue_math::Ray;
use glam::Vec3A;

/// The constants of the triangle test.
#[derive(Clone, Copy)]
pub(crate) struct RayConstants {
    /// The origin, in the order of `axes`.
    pub(crate) origin: [f32; 3],
    /// The slopes of the direction along the minor axes, then the inverse of its greatest
    /// component.
    pub(crate) shear: [f32; 3],
    /// The two minor axes, then the axis of the direction's greatest component, as byte offsets
    /// into the coordinates of a vertex.
    axes: [usize; 3],
    /// The inverse of the direction, whose components are clamped away from zero.
    inverse: Vec3A,
}

/// The constants of the box test, in all lanes. The distance of a plane is
/// `plane · inverse + offset`; the offsets of near and far planes differ by the padding.
pub(crate) struct BoxConstants<S: Simd> {
    x: AxisConstants<S>,
    y: AxisConstants<S>,
    z: AxisConstants<S>,
}

struct AxisConstants<S: Simd> {
    inverse: S::Vector,
    near_offset: S::Vector,
    far_offset: S::Vector,
    /// The near and far planes of the first node.
    near_plane: *const u8,
    far_plane: *const u8,
}

impl RayConstants {
    /// `None` for a ray that hits nothing: a coordinate is not finite, or no component of the
    /// direction is a normal number.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Option<Self> {
        let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
        let magnitude = direction.abs();
        let greatest = max_component(magnitude);
        // Zero times infinity or NaN is NaN, which propagates into the sum.
        let zero = (origin.abs() + magnitude) * 0.0;
        let usable =
            zero.cmpeq(Vec3A::ZERO).all() & (greatest >= f32::MIN_POSITIVE) & (ray.t_max > 0.0);
        if !usable {
            return None;
        }
        // A table: the axis is unpredictable, and a misprediction costs as much as a node.
        let at_greatest = magnitude.cmpge(Vec3A::splat(greatest)).bitmask() as usize;
        let axes = AXES[at_greatest & 7];
        // The division starts as early as possible, because everything else waits for it.
        let mut inverse = Vec3A::ONE / direction;
        let min_magnitude = Vec3A::splat(greatest * MIN_DIRECTION);
        if magnitude.cmplt(min_magnitude).any() {
            inverse = clamped_inverse(direction, min_magnitude);
        }
        let [x, y, z] = axes;
        let (place, slope, inverses) =
            (origin.to_array(), direction.to_array(), inverse.to_array());
        let inverse_z = inverses[z];
        Some(Self {
            origin: [place[x], place[y], place[z]],
            shear: [slope[x] * inverse_z, slope[y] * inverse_z, inverse_z],
            axes: axes.map(|axis| axis * size_of::<F32x8>()),
            inverse,
        })
    }

    /// One coordinate of a vertex of all triangles in a block; `axis` is an index into `axes`.
    #[inline(always)]
    pub(crate) fn coordinate<'a>(
        &self,
        block: &'a TriangleBlock,
        vertex: usize,
        axis: usize,
    ) -> &'a F32x8 {
        let coordinates = block.vertices[vertex].as_ptr().cast::<u8>();
        // SAFETY: `axes` holds 0, 1 and 2 times the size of `F32x8`, in some order.
        unsafe { &*coordinates.add(self.axes[axis]).cast::<F32x8>() }
    }
}

/// The inverse of a direction whose components are clamped away from zero.
#[cold]
#[inline(never)]
fn clamped_inverse(direction: Vec3A, min_magnitude: Vec3A) -> Vec3A {
    Vec3A::ONE / direction.abs().max(min_magnitude).copysign(direction)
}

/// As `max_element`, but without handling of NaN.
#[inline(always)]
fn max_component(vector: Vec3A) -> f32 {
    let greater = |a: f32, b: f32| if a > b { a } else { b };
    greater(greater(vector.x, vector.y), vector.z)
}

/// For each non-empty set of axes, three axes in cyclic order that end with one of the set.
///
/// Not a static: crates that use this one could not see that the axes are valid indices.
const AXES: &[[usize; 3]; 8] = &{
    const X: [usize; 3] = [1, 2, 0];
    const Y: [usize; 3] = [2, 0, 1];
    const Z: [usize; 3] = [0, 1, 2];
    [Z, X, Y, X, Z, X, Y, X]
};

/// For each set of negative directions, the byte offsets of the near and far planes of each axis.
static PLANES: [[usize; 6]; 8] = {
    let mut planes = [[0; 6]; 8];
    let mut signs = 0;
    while signs < 8 {
        let mut axis = 0;
        while axis < 3 {
            let side = signs >> axis & 1;
            planes[signs][2 * axis] = (2 * axis + side) * size_of::<F32x8>();
            planes[signs][2 * axis + 1] = (2 * axis + 1 - side) * size_of::<F32x8>();
            axis += 1;
        }
        signs += 1;
    }
    planes
};

impl<S: Simd> BoxConstants<S> {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray, constants: &RayConstants, nodes: &[Node]) -> Self {
        let origin = Vec3A::from(ray.origin);
        let padding = max_component(origin.abs()) * PADDING;
        let offset = -origin * constants.inverse;
        let padding = padding * constants.inverse.abs();
        // Where an offset overflows, the near one must stay too low and the far one too high, so
        // that a fused multiply-add of the far plane does not give NaN. The second operands
        // propagate NaN, which then does not bound the distance.
        let near = Vec3A::splat(f32::MAX).min(offset - padding);
        let far = Vec3A::splat(f32::MIN).max(offset + padding);
        // By the signs of the direction, which are available before its inverse is.
        let planes = &PLANES[Vec3A::from(ray.direction).is_negative_bitmask() as usize & 7];
        let [x, y, z] = constants.inverse.to_array();
        let first = nodes.as_ptr().cast::<u8>();
        let planes = planes.map(|offset| first.wrapping_add(offset));
        Self {
            x: AxisConstants::new([planes[0], planes[1]], x, near.x, far.x),
            y: AxisConstants::new([planes[2], planes[3]], y, near.y, far.y),
            z: AxisConstants::new([planes[4], planes[5]], z, near.z, far.z),
        }
    }

    /// The children whose boxes the ray meets before `t_max`, and the distances where it enters
    /// them.
    ///
    /// # Safety
    ///
    /// `offset` must be the byte offset of a node from the first of the nodes that `self` was made
    /// for, which must still be alive.
    #[inline(always)]
    pub(crate) unsafe fn intersect(&self, offset: usize, t_max: S::Vector) -> (u32, S::Vector) {
        let (x, y, z) = (&self.x, &self.y, &self.z);
        // A distance that is NaN (coordinates near overflow) does not bound the interval, because
        // the second operands are never NaN.
        // SAFETY: the caller upholds the same requirement.
        let (near, far) = unsafe {
            (
                [x.near(offset), y.near(offset), z.near(offset)],
                [x.far(offset), y.far(offset), z.far(offset)],
            )
        };
        let enter = S::max(S::max(near[0], near[1]), S::max(near[2], S::splat(0.0)));
        let leave = S::min(S::min(far[0], far[1]), S::min(far[2], t_max));
        (S::bitmask(S::less_equal(enter, leave)), enter)
    }
}

impl<S: Simd> AxisConstants<S> {
    #[inline(always)]
    fn new(
        [near_plane, far_plane]: [*const u8; 2],
        inverse: f32,
        near_offset: f32,
        far_offset: f32,
    ) -> Self {
        Self {
            inverse: S::splat(inverse),
            near_offset: S::splat(near_offset),
            far_offset: S::splat(far_offset),
            near_plane,
            far_plane,
        }
    }

    /// # Safety
    ///
    /// As for [`BoxConstants::intersect`].
    #[inline(always)]
    unsafe fn near(&self, offset: usize) -> S::Vector {
        // SAFETY: a plane of the first node plus the offset of a node is that node's plane.
        let plane = unsafe { &*self.near_plane.add(offset).cast::<F32x8>() };
        S::multiply_add(S::load(plane), self.inverse, self.near_offset)
    }

    /// # Safety
    ///
    /// As for [`BoxConstants::intersect`].
    #[inline(always)]
    unsafe fn far(&self, offset: usize) -> S::Vector {
        // SAFETY: a plane of the first node plus the offset of a node is that node's plane.
        let plane = unsafe { &*self.far_plane.add(offset).cast::<F32x8>() };
        S::multiply_add(S::load(plane), self.inverse, self.far_offset)
    }
}
