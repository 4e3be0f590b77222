//! Points on surfaces, one per lane.

use crate::ids::ShapeId;
use crate::interaction::SurfaceInteraction;
use etendue_bvh::Hit;
use etendue_math::lanes::{Frame3, LaneArray, Lanes, Real, Simd, Vector2, Vector3};
use etendue_math::{Frame, offset_origin_lanes};
use glam::{Vec2, Vec3};

/// Points on surfaces over any [`Real`], one per lane: the part of a [`SurfaceInteraction`] that
/// shading needs.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceLanes<R> {
    /// The point.
    pub point: Vector3<R>,
    /// A bound on the absolute error of each coordinate of `point`.
    pub error: Vector3<R>,
    /// The unit geometric normal, on the front of the shape.
    pub normal: Vector3<R>,
    /// The shading frame; its `n` is on the side of [`normal`](Self::normal).
    pub shading: Frame3<R>,
    /// Surface coordinates.
    pub uv: Vector2<R>,
    /// ∂point/∂u.
    pub dp_du: Vector3<R>,
    /// ∂point/∂v.
    pub dp_dv: Vector3<R>,
    /// The unit direction back along the path, in the shading frame.
    pub wi: Vector3<R>,
}

impl<R: Real> SurfaceLanes<R> {
    /// The origin of an unbounded ray that leaves the surface towards the world direction
    /// `direction`.
    #[inline(always)]
    #[must_use]
    pub fn ray_origin(&self, direction: Vector3<R>) -> Vector3<R> {
        offset_origin_lanes(self.point, self.error, self.normal, direction)
    }
}

/// [`SurfaceLanes`] in memory, as many as the widest vector holds.
#[derive(Clone, Debug, Default)]
pub struct SurfaceBatch {
    point: [LaneArray; 3],
    error: [LaneArray; 3],
    normal: [LaneArray; 3],
    shading: [[LaneArray; 3]; 3],
    uv: [LaneArray; 2],
    dp_du: [LaneArray; 3],
    dp_dv: [LaneArray; 3],
    wi: [LaneArray; 3],
}

impl SurfaceBatch {
    /// Stores surfaces, starting at index `first`.
    #[inline(always)]
    pub fn store<S: Simd>(&mut self, surfaces: &SurfaceLanes<Lanes<S>>, first: usize) {
        surfaces.point.store(&mut self.point, first);
        surfaces.error.store(&mut self.error, first);
        surfaces.normal.store(&mut self.normal, first);
        let Frame3 { s, t, n } = surfaces.shading;
        for (axis, arrays) in [s, t, n].into_iter().zip(&mut self.shading) {
            axis.store(arrays, first);
        }
        surfaces.uv.store(&mut self.uv, first);
        surfaces.dp_du.store(&mut self.dp_du, first);
        surfaces.dp_dv.store(&mut self.dp_dv, first);
        surfaces.wi.store(&mut self.wi, first);
    }

    /// Loads surfaces, starting at index `first`.
    #[inline(always)]
    #[must_use]
    pub fn load<S: Simd>(&self, simd: S, first: usize) -> SurfaceLanes<Lanes<S>> {
        let load = |arrays| Vector3::load(simd, arrays, first);
        let [s, t, n] = self.shading.each_ref().map(load);
        SurfaceLanes {
            point: load(&self.point),
            error: load(&self.error),
            normal: load(&self.normal),
            shading: Frame3 { s, t, n },
            uv: Vector2::load(simd, &self.uv, first),
            dp_du: load(&self.dp_du),
            dp_dv: load(&self.dp_dv),
            wi: load(&self.wi),
        }
    }

    /// The point of one surface.
    #[inline(always)]
    #[must_use]
    pub fn point(&self, place: usize) -> Vec3 {
        Vector3::take(&self.point, place).into()
    }

    /// The full interaction of one surface, whose hit is `hit`.
    #[must_use]
    pub fn interaction(&self, place: usize, hit: &Hit) -> SurfaceInteraction {
        let at = |arrays| Vec3::from(Vector3::take(arrays, place));
        let [s, t, n] = self.shading.each_ref().map(at);
        SurfaceInteraction {
            point: at(&self.point),
            error: at(&self.error),
            t: hit.t,
            normal: at(&self.normal),
            shading: Frame { s, t, n },
            uv: Vec2::new(self.uv[0].0[place], self.uv[1].0[place]),
            dp_du: at(&self.dp_du),
            dp_dv: at(&self.dp_dv),
            wi: at(&self.wi),
            shape: ShapeId(hit.geometry),
            primitive: hit.primitive,
            barycentric: Vec2::new(hit.u, hit.v),
            instance: None,
        }
    }
}
