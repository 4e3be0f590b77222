//! Points on flat parallelograms, the most common lights, for one or several paths.

use super::LightPoint;
use crate::interaction::ShapeSample;
use etendue_math::lanes::{LaneArray, Lanes, Real, Simd, Vector2, Vector3};
use glam::Vec2;

/// A flat parallelogram, or one per lane. Everything is affine in two random numbers.
#[derive(Clone, Copy, Debug)]
pub struct Parallelogram<R> {
    /// The point at which both numbers are zero.
    pub(super) corner: Vector3<R>,
    /// The edge vector for each number.
    pub(super) edges: [Vector3<R>; 2],
    /// A bound on the absolute error of each coordinate of any point.
    pub error: Vector3<R>,
    /// The unit geometric normal.
    pub normal: Vector3<R>,
    /// The shading normal, which decides which side emits light.
    pub shading_normal: Vector3<R>,
    /// The density of points per area: one over the area.
    pub pdf: R,
}

impl<R: Real> Parallelogram<R> {
    /// The point for two numbers in [0, 1).
    #[inline(always)]
    #[must_use]
    pub fn point(&self, random: Vector2<R>) -> Vector3<R> {
        self.corner + self.edges[0] * random.x + self.edges[1] * random.y
    }

    /// The same as a point on a light.
    #[inline(always)]
    #[must_use]
    pub fn light_point(&self, random: Vector2<R>) -> LightPoint<R> {
        let Self { error, normal, shading_normal, pdf, .. } = *self;
        LightPoint { point: self.point(random), error, normal, shading_normal, pdf }
    }
}

/// The texture coordinates of a parallelogram.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coordinates {
    pub(super) corner: Vec2,
    pub(super) edges: [Vec2; 2],
}

/// A parallelogram with its texture coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct MappedParallelogram {
    pub(super) shape: Parallelogram<f32>,
    pub(super) uv: Coordinates,
}

impl MappedParallelogram {
    #[inline]
    pub(super) fn sample(&self, random: Vec2) -> ShapeSample {
        let Coordinates { corner, edges } = self.uv;
        ShapeSample {
            point: self.shape.point(random.into()).into(),
            error: self.shape.error.into(),
            normal: self.shape.normal.into(),
            shading_normal: self.shape.shading_normal.into(),
            uv: corner + edges[0] * random.x + edges[1] * random.y,
            pdf: self.shape.pdf,
        }
    }
}

impl Parallelogram<f32> {
    /// The same in all lanes.
    #[inline(always)]
    #[must_use]
    pub fn splat<S: Simd>(&self, simd: S) -> Parallelogram<Lanes<S>> {
        let [first, second] = self.edges;
        Parallelogram {
            corner: Vector3::splat(simd, self.corner.into()),
            edges: [Vector3::splat(simd, first.into()), Vector3::splat(simd, second.into())],
            error: Vector3::splat(simd, self.error.into()),
            normal: Vector3::splat(simd, self.normal.into()),
            shading_normal: Vector3::splat(simd, self.shading_normal.into()),
            pdf: Lanes::splat(simd, self.pdf),
        }
    }
}

/// One parallelogram per lane, stored in columns.
#[derive(Clone, Debug, Default)]
pub struct ParallelogramBatch {
    corner: [LaneArray; 3],
    edges: [[LaneArray; 3]; 2],
    error: [LaneArray; 3],
    normal: [LaneArray; 3],
    shading_normal: [LaneArray; 3],
    pdf: LaneArray,
}

impl ParallelogramBatch {
    /// Stores a parallelogram in a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, shape: &Parallelogram<f32>) {
        shape.corner.put(&mut self.corner, lane);
        shape.edges[0].put(&mut self.edges[0], lane);
        shape.edges[1].put(&mut self.edges[1], lane);
        shape.error.put(&mut self.error, lane);
        shape.normal.put(&mut self.normal, lane);
        shape.shading_normal.put(&mut self.shading_normal, lane);
        self.pdf.0[lane] = shape.pdf;
    }

    /// The parallelograms of the first lanes.
    #[inline(always)]
    #[must_use]
    pub fn load<S: Simd>(&self, simd: S) -> Parallelogram<Lanes<S>> {
        let [first, second] = &self.edges;
        Parallelogram {
            corner: Vector3::load(simd, &self.corner, 0),
            edges: [Vector3::load(simd, first, 0), Vector3::load(simd, second, 0)],
            error: Vector3::load(simd, &self.error, 0),
            normal: Vector3::load(simd, &self.normal, 0),
            shading_normal: Vector3::load(simd, &self.shading_normal, 0),
            pdf: Lanes::load(simd, &self.pdf, 0),
        }
    }
}
