//! Shapes: what rays hit.
//!
//! # Contract
//! - Geometry is in world space, but for the shapes of a group, which are in the group's space.
//! - `u` and `v`, and the side that is the front (where the geometric normal points), are Mitsuba's.
//! - A hit carries barycentric coordinates, or whatever two numbers its shape needs to give a
//!   [`SurfaceInteraction`]; that is computed once, for the nearest hit only.
//! - Sampled points are uniform in area unless a shape can do better seen from a point.

pub mod bsplinecurve;
pub mod cube;
pub mod cylinder;
pub mod disk;
pub mod ellipsoids;
pub mod ellipsoidsmesh;
pub mod instance;
pub mod linearcurve;
pub mod mesh;
pub mod obj;
pub mod ply;
pub mod rectangle;
pub mod revsurface;
pub mod sdfgrid;
pub mod serialized;
pub mod shapegroup;
pub mod sphere;

use crate::ids::{EmitterId, MaterialId, ShapeId};
use crate::interaction::SurfaceInteraction;
use crate::models::mesh::Mesh;
use etendue_bvh::Hit;
use etendue_math::lanes::{Real, Vector3};
use etendue_math::{Bounds3, Frame, Ray};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A shape of the scene with what it is made of.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Where it is.
    pub geometry: Geometry,
    /// How it scatters light.
    pub material: MaterialId,
    /// The light it sends out.
    pub emitter: Option<EmitterId>,
}

/// The kinds of geometry. What is large is shared by its clones.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// Triangles.
    Mesh(Mesh),
    /// A sphere.
    Sphere(sphere::Sphere),
    /// A flat disk.
    Disk(disk::Disk),
    /// A cylinder without caps.
    Cylinder(cylinder::Cylinder),
    /// A surface of revolution.
    RevSurface(Arc<revsurface::RevSurface>),
    /// Straight tubes.
    LinearCurve(Arc<linearcurve::LinearCurve>),
    /// Tubes along splines.
    BSplineCurve(Arc<bsplinecurve::BSplineCurve>),
    /// A signed distance on a grid.
    SdfGrid(Arc<sdfgrid::SdfGrid>),
    /// A cloud of ellipsoids.
    Ellipsoids(Arc<ellipsoids::Ellipsoids>),
    /// A cloud of ellipsoids in shells of triangles.
    EllipsoidsMesh(Arc<ellipsoidsmesh::EllipsoidsMesh>),
}

/// Where on a surface a ray arrives, before the frame and coordinates that the caller may not need.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// The point.
    pub point: Vec3,
    /// A bound of the absolute error of each coordinate of `point`.
    pub error: Vec3,
    /// The unit geometric normal.
    pub normal: Vec3,
    /// The shading normal: unit, or the geometric one.
    pub shading_normal: Vec3,
    /// Surface coordinates.
    pub uv: Vec2,
    /// ∂point/∂u.
    pub dp_du: Vec3,
    /// ∂point/∂v.
    pub dp_dv: Vec3,
}

/// A point sampled on a shape, for light.
#[derive(Clone, Copy, Debug)]
pub struct ShapeSample {
    /// The point.
    pub point: Vec3,
    /// A bound of the absolute error of each coordinate of `point`.
    pub error: Vec3,
    /// The unit geometric normal.
    pub normal: Vec3,
    /// The shading normal, which decides which side sends out light.
    pub shading_normal: Vec3,
    /// Surface coordinates.
    pub uv: Vec2,
    /// The density: by area from [`Shape::sample_area`], in solid angle from [`Shape::sample_direction`].
    pub pdf: f32,
}

impl ShapeSample {
    /// What textures ask about the point, seen along `wi`, which points away from it.
    #[must_use]
    pub fn interaction(&self, shape: ShapeId, wi: Vec3) -> SurfaceInteraction {
        let shading = Frame::from_normal(self.shading_normal);
        SurfaceInteraction {
            point: self.point,
            wi: shading.to_local(wi),
            shape,
            ..SurfaceInteraction::at_uv(self.uv, shading)
        }
    }

    /// The same, taken apart and put together again. What a call returns lies in memory; where it meets
    /// a value computed in place, the compiler would put that there too, piece by piece, and read it
    /// back in larger pieces, which the processor cannot forward: 3 % of a render.
    #[inline(always)]
    fn in_registers(self) -> Self {
        let Self { point, error, normal, shading_normal, uv, pdf } = self;
        Self { point, error, normal, shading_normal, uv, pdf }
    }

    /// The same point with its density per area turned into one per solid angle seen from
    /// `reference`; `None` where the surface is seen edge-on or the points coincide.
    #[inline(always)]
    #[must_use]
    pub fn seen_from(self, reference: Vec3) -> Option<Self> {
        let pdf = area_to_solid_angle(self.pdf, self.point - reference, self.normal)?;
        Some(Self { pdf, ..self })
    }
}

/// Turns a density per area at the end of `path`, on a surface with the unit `normal`, into one per
/// solid angle at its start; `None` where it is not finite.
#[inline(always)]
#[must_use]
pub fn area_to_solid_angle(pdf: f32, path: Vec3, normal: Vec3) -> Option<f32> {
    let (pdf, exists) = area_to_solid_angle_lanes(pdf, path.into(), normal.into());
    exists.then_some(pdf)
}

/// As [`area_to_solid_angle`], over any [`Real`]; the mask says where the density is finite.
#[inline(always)]
#[must_use]
pub fn area_to_solid_angle_lanes<R: Real>(
    pdf: R,
    path: Vector3<R>,
    normal: Vector3<R>,
) -> (R, R::Mask) {
    let distance_squared = path.length_squared();
    // |cos θ| · distance = |path · normal|.
    let pdf = pdf * distance_squared * distance_squared.sqrt() / path.dot(normal).abs();
    (pdf, pdf.is_finite() & pdf.above(0.0))
}

impl Geometry {
    /// The box around all of it.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        match self {
            Self::Mesh(mesh) => mesh.bounds(),
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Disk(disk) => disk.bounds(),
            Self::Cylinder(cylinder) => cylinder.bounds(),
            Self::RevSurface(surface) => surface.bounds(),
            Self::LinearCurve(_)
            | Self::BSplineCurve(_)
            | Self::SdfGrid(_)
            | Self::Ellipsoids(_)
            | Self::EllipsoidsMesh(_) => {
                self.primitive_boxes().into_iter().fold(Bounds3::EMPTY, Bounds3::union)
            }
        }
    }

    /// The boxes around the primitives that the shape intersects itself; none for triangles.
    #[must_use]
    pub fn primitive_boxes(&self) -> Vec<Bounds3> {
        match self {
            Self::Mesh(_) => Vec::new(),
            Self::LinearCurve(curve) => curve.boxes(),
            Self::BSplineCurve(curve) => curve.boxes(),
            Self::SdfGrid(grid) => grid.boxes(),
            Self::Ellipsoids(cloud) => cloud.boxes(),
            Self::EllipsoidsMesh(cloud) => cloud.boxes(),
            _ => vec![self.bounds()],
        }
    }

    /// Makes the shape ready to be a light.
    pub fn prepare_sampling(&mut self) {
        match self {
            Self::Mesh(mesh) => mesh.prepare_sampling(),
            Self::RevSurface(surface) => Arc::make_mut(surface).prepare_sampling(),
            _ => {}
        }
    }

    /// Where `ray` arrives.
    #[inline(never)]
    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        match self {
            Self::Mesh(mesh) => mesh.surface_point(hit.primitive, Vec2::new(hit.u, hit.v)),
            Self::Sphere(sphere) => sphere.surface_point(ray, hit.t),
            Self::Disk(disk) => disk.surface_point(Vec2::new(hit.u, hit.v)),
            Self::Cylinder(cylinder) => cylinder.surface_point(Vec2::new(hit.u, hit.v)),
            Self::RevSurface(surface) => surface.surface_point(ray, hit.t, Vec2::new(hit.u, hit.v)),
            Self::LinearCurve(curve) => curve.surface_point(hit.primitive, ray, hit.t),
            Self::BSplineCurve(curve) => curve.surface_point(hit.primitive, ray, (hit.t, hit.u)),
            Self::SdfGrid(grid) => grid.surface_point(hit.primitive, ray, hit.t),
            Self::Ellipsoids(cloud) => cloud.surface_point(hit.primitive, ray),
            Self::EllipsoidsMesh(cloud) => {
                cloud.surface_point(hit.primitive, Vec2::new(hit.u, hit.v))
            }
        }
    }

    /// How many triangles or other primitives there are.
    #[must_use]
    pub fn primitive_count(&self) -> usize {
        match self {
            Self::Mesh(mesh) => mesh.triangles().len(),
            Self::LinearCurve(curve) => curve.segment_count(),
            Self::BSplineCurve(curve) => curve.segment_count(),
            Self::SdfGrid(grid) => grid.voxel_count(),
            Self::Ellipsoids(cloud) => cloud.count(),
            Self::EllipsoidsMesh(cloud) => cloud.triangle_count(),
            _ => 1,
        }
    }
}

impl Shape {
    /// Everything that is known where `ray` has met this shape.
    #[inline(always)]
    #[must_use]
    pub fn interaction(&self, id: ShapeId, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        let surface = match &self.geometry {
            Geometry::Mesh(mesh) => mesh.surface_point(hit.primitive, Vec2::new(hit.u, hit.v)),
            other => other.surface_point(ray, hit).in_registers(),
        };
        let shading = Frame::from_normal_and_tangent(surface.shading_normal, surface.dp_du);
        SurfaceInteraction {
            point: surface.point,
            error: surface.error,
            t: hit.t,
            normal: surface.normal,
            shading,
            uv: surface.uv,
            dp_du: surface.dp_du,
            dp_dv: surface.dp_dv,
            wi: shading.to_local(-ray.direction),
            shape: id,
            primitive: hit.primitive,
            barycentric: Vec2::new(hit.u, hit.v),
            instance: None,
        }
    }

    /// The box around the shape.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.geometry.bounds()
    }

    /// The area of the surface; zero for curves, distances on a grid and clouds
    /// of ellipsoids, which are not sampled as lights.
    #[must_use]
    pub fn area(&self) -> f32 {
        match &self.geometry {
            Geometry::Mesh(mesh) => mesh.area(),
            Geometry::Sphere(sphere) => sphere.area(),
            Geometry::Disk(disk) => disk.area(),
            Geometry::Cylinder(cylinder) => cylinder.area(),
            Geometry::RevSurface(surface) => surface.area(),
            Geometry::LinearCurve(_)
            | Geometry::BSplineCurve(_)
            | Geometry::SdfGrid(_)
            | Geometry::Ellipsoids(_)
            | Geometry::EllipsoidsMesh(_) => 0.0,
        }
    }

    /// A point uniform in area.
    #[must_use]
    pub fn sample_area(&self, random: Vec2) -> Option<ShapeSample> {
        match &self.geometry {
            Geometry::Mesh(mesh) => mesh.sample_area(random),
            Geometry::Sphere(sphere) => Some(sphere.sample_area(random)),
            Geometry::Disk(disk) => Some(disk.sample_area(random)),
            Geometry::Cylinder(cylinder) => Some(cylinder.sample_area(random)),
            Geometry::RevSurface(surface) => surface.sample_area(random),
            Geometry::LinearCurve(_)
            | Geometry::BSplineCurve(_)
            | Geometry::SdfGrid(_)
            | Geometry::Ellipsoids(_)
            | Geometry::EllipsoidsMesh(_) => None,
        }
    }

    /// A point of the surface as seen from `reference`, with its density in solid angle there.
    #[inline(always)]
    #[must_use]
    pub fn sample_direction(&self, reference: Vec3, random: Vec2) -> Option<ShapeSample> {
        // Most lights are rectangles.
        if let Geometry::Mesh(mesh) = &self.geometry
            && let Some(sample) = mesh.sample_parallelogram(random)
        {
            return sample.seen_from(reference);
        }
        Some(self.sample_any_direction(reference, random)?.in_registers())
    }

    #[inline(never)]
    fn sample_any_direction(&self, reference: Vec3, random: Vec2) -> Option<ShapeSample> {
        match &self.geometry {
            Geometry::Sphere(sphere) => sphere.sample_direction(reference, random),
            _ => self.sample_area(random)?.seen_from(reference),
        }
    }

    /// The density in solid angle with which [`Self::sample_direction`] chooses a point of the
    /// surface that is known.
    #[inline]
    #[must_use]
    pub fn pdf_direction(&self, reference: Vec3, surface: &SurfaceInteraction) -> f32 {
        match &self.geometry {
            Geometry::Sphere(sphere) => {
                sphere.pdf_direction(reference, surface.point, surface.normal)
            }
            geometry => {
                let pdf = match geometry {
                    Geometry::Mesh(mesh) => mesh.pdf_area(surface),
                    Geometry::RevSurface(shape) => {
                        shape.pdf_area(surface.uv.y, surface.dp_du, surface.dp_dv)
                    }
                    _ => 1.0 / self.area(),
                };
                let path = surface.point - reference;
                area_to_solid_angle(pdf, path, surface.normal).unwrap_or(0.0)
            }
        }
    }

    /// How many triangles or other primitives the shape has.
    #[must_use]
    pub fn primitive_count(&self) -> usize {
        self.geometry.primitive_count()
    }
}

impl SurfacePoint {
    /// As [`ShapeSample::in_registers`].
    #[inline(always)]
    fn in_registers(self) -> Self {
        let Self { point, error, normal, shading_normal, uv, dp_du, dp_dv } = self;
        Self { point, error, normal, shading_normal, uv, dp_du, dp_dv }
    }
}
