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

/// The list of shapes with geometry of their own: one line is one plugin, its XML `type`, which is its
/// module as well, and its type in that module, which is a [`ShapeModel`].
///
/// - `plain` shapes are small; `shared` ones are not: clones share them.
/// - `meshes` become triangles: they build a [`Mesh`].
/// - `composites` are made of other shapes; the scene's builder resolves them.
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

/// What a shape plugin computes; see the module's contract.
pub(crate) trait ShapeModel {
    /// The box around all of it.
    fn bounds(&self) -> Bounds3;

    /// The boxes around the primitives that the shape intersects itself: one around it all, unless it
    /// has several. Triangles have none.
    fn primitive_boxes(&self) -> Vec<Bounds3> {
        vec![self.bounds()]
    }

    /// How many primitives there are.
    fn primitive_count(&self) -> usize {
        1
    }

    /// Where `ray` meets a primitive first.
    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<PrimitiveHit>;

    /// Whether `ray` meets a primitive at all, which may be quicker to find out than where.
    fn occludes(&self, primitive: u32, ray: &Ray) -> bool {
        self.intersect(primitive, ray).is_some()
    }

    /// Where `ray` arrives.
    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint;

    /// Whether the shape has to be made ready before it is sampled as a light.
    const PREPARES_SAMPLING: bool = false;

    /// Makes the shape ready to be sampled as a light, if [that](Self::PREPARES_SAMPLING) takes anything.
    fn prepare_sampling(&mut self) {}

    /// The area; zero for shapes that are not sampled as lights.
    fn area(&self) -> f32 {
        0.0
    }

    /// A point uniform in area, or as its picture has it; none where shapes are not sampled as lights.
    fn sample_area(&self, _random: Vec2) -> Option<ShapeSample> {
        None
    }

    /// The density per area with which [`sample_area`](Self::sample_area) chooses a point.
    fn pdf_area(&self, _surface: &SurfaceInteraction) -> f32 {
        1.0 / self.area()
    }

    /// See [`Shape::sample_direction`]; a point uniform in area unless the shape can do better.
    fn sample_direction(&self, reference: Vec3, random: Vec2) -> Option<ShapeSample> {
        self.sample_area(random)?.seen_from(reference)
    }

    /// The density of [`sample_direction`](Self::sample_direction).
    fn pdf_direction(&self, reference: Vec3, surface: &SurfaceInteraction) -> f32 {
        let path = surface.point - reference;
        area_to_solid_angle(self.pdf_area(surface), path, surface.normal).unwrap_or(0.0)
    }

    /// Bytes of memory held beside the shape itself.
    fn memory_bytes(&self) -> usize {
        0
    }
}

/// Makes the enum of geometry, its dispatch and the registry from the list.
macro_rules! shapes {
    (
        plain { $($module:ident => $name:ident;)* }
        shared { $($shared_module:ident => $shared:ident;)* }
        meshes { $($mesh:ident;)* }
        composites { $($composite:ident;)* }
    ) => {
        /// The kinds of geometry. What is large is shared by its clones.
        #[derive(Clone, Debug)]
        pub enum Geometry {
            /// Triangles.
            Mesh(Mesh),
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $name($module::$name),)*
            $(#[doc = concat!("See [`", stringify!($shared_module), "`].")]
            $shared(Arc<$shared_module::$shared>),)*
        }

        /// Every shape with geometry of its own.
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

        /// The shapes that are made of others: their names and pages.
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
            /// Makes the shape ready to be a light.
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

/// Builds the geometry of a shape. Only this step reads files, so that it can run in parallel.
pub type BuildGeometry = fn(&Assets<'_>, &Parameters<'_>) -> Option<Geometry>;

impl ShapeModel for Mesh {
    fn bounds(&self) -> Bounds3 {
        self.bounds()
    }

    /// The tree knows the triangles.
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

/// The box around several primitives.
fn union(boxes: Vec<Bounds3>) -> Bounds3 {
    boxes.into_iter().fold(Bounds3::EMPTY, Bounds3::union)
}

impl Geometry {
    /// The box around all of it.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        with_shape!(self, shape => ShapeModel::bounds(shape))
    }

    /// The boxes around the primitives that the shape intersects itself; none for triangles.
    #[must_use]
    pub fn primitive_boxes(&self) -> Vec<Bounds3> {
        with_shape!(self, shape => ShapeModel::primitive_boxes(shape))
    }

    /// How many triangles or other primitives there are.
    #[must_use]
    pub fn primitive_count(&self) -> usize {
        with_shape!(self, shape => ShapeModel::primitive_count(shape))
    }

    /// Where `ray` meets a primitive that the shape intersects itself.
    #[inline]
    pub(crate) fn intersect(&self, primitive: u32, ray: &Ray) -> Option<PrimitiveHit> {
        with_shape!(self, shape => ShapeModel::intersect(shape, primitive, ray))
    }

    /// Whether `ray` meets a primitive that the shape intersects itself.
    #[inline]
    pub(crate) fn occludes(&self, primitive: u32, ray: &Ray) -> bool {
        with_shape!(self, shape => ShapeModel::occludes(shape, primitive, ray))
    }

    /// Where `ray` arrives.
    #[inline(never)]
    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        with_shape!(self, shape => ShapeModel::surface_point(shape, ray, hit))
    }

    /// Bytes of memory held beside the geometry itself.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        with_shape!(self, shape => ShapeModel::memory_bytes(shape))
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

    /// The area of the surface; zero for shapes that are not sampled as lights.
    #[must_use]
    pub fn area(&self) -> f32 {
        with_shape!(&self.geometry, shape => ShapeModel::area(shape))
    }

    /// A point uniform in area.
    #[must_use]
    pub fn sample_area(&self, random: Vec2) -> Option<ShapeSample> {
        with_shape!(&self.geometry, shape => ShapeModel::sample_area(shape, random))
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
        with_shape!(&self.geometry, shape => ShapeModel::sample_direction(shape, reference, random))
    }

    /// The density in solid angle with which [`Self::sample_direction`] chooses a point of the
    /// surface that is known.
    #[inline]
    #[must_use]
    pub fn pdf_direction(&self, reference: Vec3, surface: &SurfaceInteraction) -> f32 {
        with_shape!(&self.geometry, shape => ShapeModel::pdf_direction(shape, reference, surface))
    }

    /// How many triangles or other primitives the shape has.
    #[must_use]
    pub fn primitive_count(&self) -> usize {
        self.geometry.primitive_count()
    }
}
