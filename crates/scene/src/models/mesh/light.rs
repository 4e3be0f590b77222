//! Points on emissive meshes, for several paths at once.

use super::triangle::{CornerBatch, Place};
use super::{AreaSampling, Mesh, choose_triangle};
use etendue_math::lanes::{LaneArray, Lanes, Real, Simd, Vector2, Vector3};
use etendue_sampling::warp;
use glam::Vec2;

/// A point on a light, or one per lane: a [`ShapeSample`](crate::shape::ShapeSample) without
/// texture coordinates.
#[derive(Clone, Copy, Debug)]
pub struct LightPoint<R> {
    /// The point.
    pub point: Vector3<R>,
    /// A bound on the absolute error of each coordinate of `point`.
    pub error: Vector3<R>,
    /// The unit geometric normal.
    pub normal: Vector3<R>,
    /// The shading normal, which decides which side emits light.
    pub shading_normal: Vector3<R>,
    /// The density per area.
    pub pdf: R,
}

impl<R: Real> LightPoint<R> {
    /// `yes` if the mask is true, else `no`.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            point: Vector3::select(mask, yes.point, no.point),
            error: Vector3::select(mask, yes.error, no.error),
            normal: Vector3::select(mask, yes.normal, no.normal),
            shading_normal: Vector3::select(mask, yes.shading_normal, no.shading_normal),
            pdf: R::select(mask, yes.pdf, no.pdf),
        }
    }
}

/// Triangles sampled on emissive meshes, one per lane, stored in columns.
#[derive(Clone, Debug, Default)]
pub struct LightPointBatch {
    corners: CornerBatch,
    /// The random numbers that remain after the triangles are selected.
    random: [LaneArray; 2],
    /// The areas of the entire meshes.
    area: LaneArray,
}

impl LightPointBatch {
    /// Selects a triangle of `mesh` for a lane, as [`Mesh::sample_area`] does.
    ///
    /// The mesh must [select triangles by area](Mesh::chooses_triangles). For other meshes, the
    /// lane gets a point of infinite density, which no path can use.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, mesh: &Mesh, random: Vec2) {
        let Some(AreaSampling::Triangles(table)) = &mesh.sampling else { return };
        let (triangle, rest) = choose_triangle(table, random);
        self.corners.set(lane, mesh, mesh.indices[triangle].map(|vertex| vertex as usize));
        Vector2::from(rest).put(&mut self.random, lane);
        self.area.0[lane] = mesh.area;
    }

    /// The points of the first lanes.
    #[inline(always)]
    #[must_use]
    pub fn points<S: Simd>(&self, simd: S) -> LightPoint<Lanes<S>> {
        let random = Vector2::load(simd, &self.random, 0);
        let barycentric = warp::uniform_triangle::sample_lanes(random);
        let place = self.corners.load(simd, 0).place(barycentric);
        let Place { point, error, normal, shading_normal } = place;
        let pdf = Lanes::load(simd, &self.area, 0).reciprocal();
        LightPoint { point, error, normal, shading_normal, pdf }
    }
}

impl Mesh {
    /// Whether point sampling selects a triangle by area and then a point in it.
    #[must_use]
    pub fn chooses_triangles(&self) -> bool {
        matches!(self.sampling, Some(AreaSampling::Triangles(_)))
    }
}
