//! What the tests need of a ray, computed once per ray.

use crate::error_bounds::{LEAST_DIRECTION, PADDING};
use crate::node::{F32x8, Node, TriangleBlock};
use crate::simd::Simd;
use etendue_math::Ray;
use glam::Vec3A;

/// The constants of the triangle test.
#[derive(Clone, Copy)]
pub(crate) struct RayConstants {
    /// The origin, in the order of `axes`.
    pub(crate) origin: [f32; 3],
    /// The direction's slope along the minor axes, then one over its greatest component.
    pub(crate) shear: [f32; 3],
    /// The two minor axes, then that of the direction's greatest component, as distances in bytes
    /// between the coordinates of a vertex.
    axes: [usize; 3],
    /// One over the direction, whose components are held off zero.
    inverse: Vec3A,
}

/// The constants of the box test, in all lanes: distances on an axis are
/// `plane · inverse + offset`, and the offset differs between near and far planes by the padding.
pub(crate) struct BoxConstants<S: Simd> {
    x: AxisConstants<S>,
    y: AxisConstants<S>,
    z: AxisConstants<S>,
}

struct AxisConstants<S: Simd> {
    inverse: S::Vector,
    near_offset: S::Vector,
    far_offset: S::Vector,
    /// Those of the first node's planes that are met first and last.
    near_plane: *const u8,
    far_plane: *const u8,
}

impl RayConstants {
    /// `None` for a ray that hits nothing: with a coordinate that is not finite, or a direction
    /// without a normal number in it.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Option<Self> {
        let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
        let size = direction.abs();
        let greatest = greatest_component(size);
        // Zero times a number that is not finite is not a number, and neither is their sum.
        let zero = (origin.abs() + size) * 0.0;
        let usable =
            zero.cmpeq(Vec3A::ZERO).all() & (greatest >= f32::MIN_POSITIVE) & (ray.t_max > 0.0);
        if !usable {
            return None;
        }
        // By table: which axis it is cannot be foretold, and a wrong guess costs as much as a node.
        let at_greatest = size.cmpge(Vec3A::splat(greatest)).bitmask() as usize;
        let axes = AXES[at_greatest & 7];
        // The division starts at once: what follows a ray waits for it.
        let mut inverse = Vec3A::ONE / direction;
        let least = Vec3A::splat(greatest * LEAST_DIRECTION);
        if size.cmplt(least).any() {
            inverse = held_off_zero(direction, least);
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

    /// A vertex's coordinates of a block in the order of `axes`.
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

/// One over a direction whose components are held off zero.
#[cold]
#[inline(never)]
fn held_off_zero(direction: Vec3A, least: Vec3A) -> Vec3A {
    Vec3A::ONE / direction.abs().max(least).copysign(direction)
}

/// As `max_element`, without its care for what is not a number.
#[inline(always)]
fn greatest_component(vector: Vec3A) -> f32 {
    let greater = |a: f32, b: f32| if a > b { a } else { b };
    greater(greater(vector.x, vector.y), vector.z)
}

/// Three axes in cyclic order, the last of which is among the bits of the place.
static AXES: [[usize; 3]; 8] = {
    const X: [usize; 3] = [1, 2, 0];
    const Y: [usize; 3] = [2, 0, 1];
    const Z: [usize; 3] = [0, 1, 2];
    [Z, X, Y, X, Z, X, Y, X]
};

/// For each set of negative directions, the distances of the near and far planes of the axes.
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
        let padding = greatest_component(origin.abs()) * PADDING;
        let offset = -origin * constants.inverse;
        let padding = padding * constants.inverse.abs();
        // Where an offset leaves the range, the near one must stay too low and the far one too
        // high: a fused product of the far plane does not overflow beside an infinity. The second
        // operands pass on what is not a number, which then bounds nothing.
        let near = Vec3A::splat(f32::MAX).min(offset - padding);
        let far = Vec3A::splat(f32::MIN).max(offset + padding);
        // By the direction's signs, which are there before its inverse is.
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

    /// Which children's boxes the ray meets before `t_max`, and where it enters them.
    ///
    /// # Safety
    ///
    /// `offset` must be the distance in bytes of a node from the first of the nodes that `self` was
    /// made for, which must still be there.
    #[inline(always)]
    pub(crate) unsafe fn meet(&self, offset: usize, t_max: S::Vector) -> (u32, S::Vector) {
        let (x, y, z) = (&self.x, &self.y, &self.z);
        // A distance that is not a number (coordinates near the end of the range) does not bound:
        // the second operands are never NaN.
        // SAFETY: the caller's promise is the one that is asked for.
        let (near, far) = unsafe {
            (
                [x.near(offset), y.near(offset), z.near(offset)],
                [x.far(offset), y.far(offset), z.far(offset)],
            )
        };
        let enter = S::greatest(S::greatest(near[0], near[1]), S::greatest(near[2], S::splat(0.0)));
        let leave = S::least(S::least(far[0], far[1]), S::least(far[2], t_max));
        (S::bits(S::less_equal(enter, leave)), enter)
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
    /// As for [`BoxConstants::meet`].
    #[inline(always)]
    unsafe fn near(&self, offset: usize) -> S::Vector {
        // SAFETY: a plane of the first node and the distance of another give the other's plane.
        let plane = unsafe { &*self.near_plane.add(offset).cast::<F32x8>() };
        S::multiply_add(S::load(plane), self.inverse, self.near_offset)
    }

    /// # Safety
    ///
    /// As for [`BoxConstants::meet`].
    #[inline(always)]
    unsafe fn far(&self, offset: usize) -> S::Vector {
        // SAFETY: a plane of the first node and the distance of another give the other's plane.
        let plane = unsafe { &*self.far_plane.add(offset).cast::<F32x8>() };
        S::multiply_add(S::load(plane), self.inverse, self.far_offset)
    }
}
