//! Shapes: surfaces that rays can hit.
//!
//! # Contract
//! - Geometry is in world space. Shapes of a group are in the group's space.
//! - `u`, `v` and the front side (where the geometric normal points) follow Mitsuba.
//! - A hit carries barycentric coordinates, or any two numbers from which its shape can compute a
//!   [`SurfaceInteraction`]. That is computed once, for the nearest hit only.
//! - Sampled points are uniform in area unless a shape can do better as seen from a point.

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

pub use crate::interaction::{
    ShapeSample, SurfacePoint, area_to_solid_angle, area_to_solid_angle_lanes,
};

use crate::builder::Assets;
use crate::ids::{EmitterId, MaterialId, ShapeId};
use crate::interaction::SurfaceInteraction;
use crate::models::mesh::Mesh;
use crate::plugin::{Plugin, plugin};
use etendue_bvh::{Hit, PrimitiveHit};
use etendue_document::Parameters;
use etendue_math::{Bounds3, Frame, Ray};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A shape of the scene with its material and emitter.
#[derive(Clone, Debug)]
pub struct Shape {
    /// The geometry.
    pub geometry: Geometry,
    /// The material.
    pub material: MaterialId,
    /// The emitter, if the shape emits light.
    pub emitter: Option<EmitterId>,
}

/// The list of shapes with their own geometry. Each line is one plugin: its XML `type`, which is
/// also its module, and the type in that module that implements [`ShapeModel`].
///
/// - `plain` shapes are small. `shared` shapes are large, so clones share them.
/// - `meshes` build a [`Mesh`] of triangles.
/// - `composites` consist of other shapes; the scene's builder resolves them.
macro_rules! shape_list {
    ($macro:ident) => {
        $macro! {
            plain {
                cylinder => Cylinder;
                disk => Disk;
                sphere => Sphere;
            }
            shared {
                bsplinecurve => BSplineCurve;
                ellipsoids => Ellipsoids;
                ellipsoidsmesh => EllipsoidsMesh;
                linearcurve => LinearCurve;
                revsurface => RevSurface;
                sdfgrid => SdfGrid;
            }
            meshes {
                cube;
                mesh;
                obj;
                ply;
                rectangle;
                serialized;
            }
            composites {
                instance;
                shapegroup;
            }
        }
    };
}

/// The operations of a shape plugin; see the module's contract.
pub(crate) trait ShapeModel {
    /// The bounding box of the whole shape.
    fn bounds(&self) -> Bounds3;

    /// The bounding boxes of the primitives that the shape intersects itself: one for the whole
    /// shape, unless it has several. None for triangles.
    fn primitive_boxes(&self) -> Vec<Bounds3> {
        vec![self.bounds()]
    }

    /// The number of primitives.
    fn primitive_count(&self) -> usize {
        1
    }

    /// The nearest intersection of `ray` with a primitive.
    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<PrimitiveHit>;

    /// Whether `ray` hits a primitive at all, which may be cheaper than finding where.
    fn occludes(&self, primitive: u32, ray: &Ray) -> bool {
        self.intersect(primitive, ray).is_some()
    }

    /// The surface point that `ray` hits.
    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint;

    /// Whether the shape must be prepared before it is sampled as a light.
    const PREPARES_SAMPLING: bool = false;

    /// Prepares the shape for sampling as a light, if [required](Self::PREPARES_SAMPLING).
    fn prepare_sampling(&mut self) {}

    /// The area; zero for shapes that cannot be sampled as lights.
    fn area(&self) -> f32 {
        0.0
    }

    /// Samples a point uniform in area, or by its texture; `None` if the shape cannot be sampled.
    fn sample_area(&self, _random: Vec2) -> Option<ShapeSample> {
        None
    }

    /// The density per area with which [`sample_area`](Self::sample_area) chooses a point.
    fn pdf_area(&self, _surface: &SurfaceInteraction) -> f32 {
        1.0 / self.area()
    }

    /// See [`Shape::sample_direction`]; uniform in area unless the shape can do better.
    fn sample_direction(&self, reference: Vec3, random: Vec2) -> Option<ShapeSample> {
        self.sample_area(random)?.seen_from(reference)
    }

    /// The density of [`sample_direction`](Self::sample_direction).
    fn pdf_direction(&self, reference: Vec3, surface: &SurfaceInteraction) -> f32 {
        let path = surface.point - reference;
        area_to_solid_angle(self.pdf_area(surface), path, surface.normal).unwrap_or(0.0)
    }

    /// Memory use in bytes, excluding the shape itself.
    fn memory_bytes(&self) -> usize {
        0
    }
}

/// Generates the enum of geometries, its dispatch and the registry from the list.
macro_rules! shapes {
    (
        plain { $($module:ident => $name:ident;)* }
        shared { $($shared_module:ident => $shared:ident;)* }
        meshes { $($mesh:ident;)* }
        composites { $($composite:ident;)* }
    ) => {
        /// The kinds of geometry. Clones share large data.
        #[derive(Clone, Debug)]
        pub enum Geometry {
            /// Triangles.
            Mesh(Mesh),
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $name($module::$name),)*
            $(#[doc = concat!("See [`", stringify!($shared_module), "`].")]
            $shared(Arc<$shared_module::$shared>),)*
        }

        /// Every shape with its own geometry.
        pub static SHAPES: &[Plugin<BuildGeometry>] = &[
            $(plugin(stringify!($module), &$module::MANUAL, |assets, parameters| {
                $module::build(assets, parameters).map(Geometry::$name)
            }),)*
            $(plugin(stringify!($shared_module), &$shared_module::MANUAL, |assets, parameters| {
                let shape = $shared_module::build(assets, parameters)?;
                Some(Geometry::$shared(Arc::new(shape)))
            }),)*
            $(plugin(stringify!($mesh), &$mesh::MANUAL, |assets, parameters| {
                $mesh::build(assets, parameters).map(Geometry::Mesh)
            }),)*
        ];

        /// The names and manual pages of the shapes that consist of other shapes.
        pub static COMPOSITE_SHAPES: &[Plugin<()>] =
            &[$(plugin(stringify!($composite), &$composite::MANUAL, ())),*];

        /// Runs `$work` with the [`ShapeModel`] of a geometry.
        macro_rules! with_shape {
            ($geometry:expr, $shape:ident => $work:expr) => {
                match $geometry {
                    Geometry::Mesh($shape) => $work,
                    $(Geometry::$name($shape) => $work,)*
                    $(Geometry::$shared(shared) => {
                        let $shape = shared.as_ref();
                        $work
                    })*
                }
            };
        }

        impl Geometry {
            /// Prepares the shape for sampling as a light.
            pub fn prepare_sampling(&mut self) {
                match self {
                    Self::Mesh(mesh) => ShapeModel::prepare_sampling(mesh),
                    $(Self::$name(shape) => ShapeModel::prepare_sampling(shape),)*
                    $(Self::$shared(shape) => {
                        if $shared_module::$shared::PREPARES_SAMPLING {
                            ShapeModel::prepare_sampling(Arc::make_mut(shape));
                        }
                    })*
                }
            }
        }
    };
}

shape_list!(shapes);

/// Builds the geometry of a shape. Only this step reads files, so it can run in parallel.
pub type BuildGeometry = fn(&Assets<'_>, &Parameters<'_>) -> Option<Geometry>;

impl ShapeModel for Mesh {
    fn bounds(&self) -> Bounds3 {
        self.bounds()
    }

    /// The tree stores the triangles.
    fn primitive_boxes(&self) -> Vec<Bounds3> {
        Vec::new()
    }

    fn primitive_count(&self) -> usize {
        self.triangles().len()
    }

    /// The tree intersects the triangles.
    fn intersect(&self, _primitive: u32, _ray: &Ray) -> Option<PrimitiveHit> {
        None
    }

    fn surface_point(&self, _ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.surface_point(hit.primitive, Vec2::new(hit.u, hit.v))
    }

    fn prepare_sampling(&mut self) {
        self.prepare_sampling();
    }

    fn area(&self) -> f32 {
        self.area()
    }

    fn sample_area(&self, random: Vec2) -> Option<ShapeSample> {
        self.sample_area(random)
    }

    fn pdf_area(&self, surface: &SurfaceInteraction) -> f32 {
        self.pdf_area(surface)
    }

    fn memory_bytes(&self) -> usize {
        self.memory_bytes()
    }
}

/// The union of the primitives' bounding boxes.
fn union(boxes: Vec<Bounds3>) -> Bounds3 {
    boxes.into_iter().fold(Bounds3::EMPTY, Bounds3::union)
}

impl Geometry {
    /// The bounding box of the whole shape.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        with_shape!(self, shape => ShapeModel::bounds(shape))
    }

    /// The bounding boxes of the primitives that the shape intersects itself; none for triangles.
    #[must_use]
    pub fn primitive_boxes(&self) -> Vec<Bounds3> {
        with_shape!(self, shape => ShapeModel::primitive_boxes(shape))
    }

    /// The surface area; zero for shapes that cannot be sampled as lights.
    #[must_use]
    pub(crate) fn area(&self) -> f32 {
        with_shape!(self, shape => ShapeModel::area(shape))
    }

    /// The number of triangles or other primitives.
    #[must_use]
    pub fn primitive_count(&self) -> usize {
        with_shape!(self, shape => ShapeModel::primitive_count(shape))
    }

    /// The nearest intersection of `ray` with a primitive that the shape intersects itself.
    #[inline]
    pub(crate) fn intersect(&self, primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        with_shape!(self, shape => ShapeModel::intersect(shape, primitive, ray))
    }

    /// Whether `ray` hits a primitive that the shape intersects itself.
    #[inline]
    pub(crate) fn occludes(&self, primitive: u32, ray: &Ray) -> bool {
        with_shape!(self, shape => ShapeModel::occludes(shape, primitive, ray))
    }

    /// The surface point that `ray` hits.
    #[inline(never)]
    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        with_shape!(self, shape => ShapeModel::surface_point(shape, ray, hit))
    }

    /// Memory use in bytes, excluding the geometry itself.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        with_shape!(self, shape => ShapeModel::memory_bytes(shape))
    }
}

impl Shape {
    /// Computes the full interaction where `ray` hits this shape.
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

    /// The bounding box of the shape.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.geometry.bounds()
    }

    /// The surface area; zero for shapes that cannot be sampled as lights.
    #[must_use]
    pub fn area(&self) -> f32 {
        with_shape!(&self.geometry, shape => ShapeModel::area(shape))
    }

    /// Samples a point uniform in area.
    #[must_use]
    pub fn sample_area(&self, random: Vec2) -> Option<ShapeSample> {
        with_shape!(&self.geometry, shape => ShapeModel::sample_area(shape, random))
    }

    /// Samples a point of the surface as seen from `reference`, with its density in solid angle
    /// there.
    #[inline(always)]
    #[must_use]
    pub fn sample_direction(&self, reference: Vec3, random: Vec2) -> Option<ShapeSample> {
        // A fast path: most lights are rectangles.
        if let Geometry::Mesh(mesh) = &self.geometry
            && let Some(sample) = mesh.sample_parallelogram(random)
        {
            return sample.seen_from(reference);
        }
        Some(self.sample_any_direction(reference, random)?.in_registers())
    }

    #[inline(never)]
    fn sample_any_direction(&self, reference: Vec3, random: Vec2) -> Option<ShapeSample> {
        with_shape!(&self.geometry, shape => ShapeModel::sample_direction(shape, reference, random))
    }

    /// The density in solid angle with which [`Self::sample_direction`] chooses a given point of
    /// the surface.
    #[inline]
    #[must_use]
    pub fn pdf_direction(&self, reference: Vec3, surface: &SurfaceInteraction) -> f32 {
        with_shape!(&self.geometry, shape => ShapeModel::pdf_direction(shape, reference, surface))
    }

    /// The number of triangles or other primitives.
    #[must_use]
    pub fn primitive_count(&self) -> usize {
        self.geometry.primitive_count()
    }
}
