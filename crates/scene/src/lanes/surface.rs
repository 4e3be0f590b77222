//! Points on surfaces, several at once.

use crate::ids::ShapeId;
use crate::interaction::SurfaceInteraction;
use etendue_bvh::Hit;
use etendue_math::lanes::{Frame3, LaneArray, Lanes, Real, Simd, Vector2, Vector3};
use etendue_math::{Frame, offset_origin_lanes};
use glam::{Vec2, Vec3};

/// Points on surfaces over any [`Real`]: what shading needs of a [`SurfaceInteraction`], one for each
/// lane.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceLanes<R> {
    /// The point.
    pub point: Vector3<R>,
    /// A bound of the absolute error of each coordinate of `point`.
    pub error: Vector3<R>,
    /// The unit geometric normal, on the side that the shape calls its front.
    pub normal: Vector3<R>,
    /// The shading frame; its `n` is on the side of [`normal`](Self::normal).
    pub shading: Frame3<R>,
    /// Surface coordinates.
    pub uv: Vector2<R>,
    /// ∂point/∂u.
    pub dp_du: Vector3<R>,
    /// ∂point/∂v.
    pub dp_dv: Vector3<R>,
    /// The unit direction that the path came from, away from the surface, in the shading frame.
    pub wi: Vector3<R>,
}

impl<R: Real> SurfaceLanes<R> {
    /// The origin of an unbounded ray that leaves the surface towards the world direction `direction`.
    #[inline(always)]
    #[must_use]
    pub fn ray_origin(&self, direction: Vector3<R>) -> Vector3<R> {
        offset_origin_lanes(self.point, self.error, self.normal, direction)
    }
}

/// As many [`SurfaceLanes`] as the widest lanes take, in memory.
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
    /// Stores surfaces, from the place `first` on.
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

    /// The surfaces from the place `first` on.
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

    /// The point of the surface in one place.
    #[inline(always)]
    #[must_use]
    pub fn point(&self, place: usize) -> Vec3 {
        Vector3::take(&self.point, place).into()
    }

    /// All that is known of the surface in one place, which is that of `hit`.
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
