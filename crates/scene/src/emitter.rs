//! Emitters: the sources of light.
//!
//! # Contract
//! - [`Emitter::sample_direction`] samples a direction from which light may reach a given point.
//!   Its `pdf` is in solid angle at that point, or 1 for delta emitters, which rays cannot hit.
//! - [`Emitter::pdf_direction`] is the density with which it samples a given direction. It serves
//!   rays that found the emitter in another way.
//! - Radiance is not divided by the density. Visibility is left to the caller.

pub mod area;
pub mod constant;
pub mod directional;
pub mod directionalarea;
pub mod envmap;
pub mod point;
pub mod projector;
pub mod spot;
pub mod sunsky;
#[cfg(test)]
mod tests;

pub use crate::lanes::{LightLanes, TargetLanes};

use crate::builder::Builder;
use crate::ids::ShapeId;
use crate::interaction::SurfaceInteraction;
use crate::lanes::{SHADOW_RAY_LENGTH, shadow_segment};
use crate::manual::{ParameterManual, parameter};
use crate::plugin::{Plugin, plugin};
use crate::shape::Shape;
use crate::texture::Textures;
use area::ParallelogramLight;
use etendue_document::Parameters;
use etendue_math::{Bounds3, Frame, Ray, offset_ray_origin};
use etendue_sampling::warp;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The list of emitters, one line per plugin: its XML `type`, which is also its module, and the
/// [`Light`] that the scene stores. Those of `shapes` are nested in a shape.
macro_rules! emitter_list {
    ($macro:ident) => {
        $macro! {
            free {
                constant => Constant(constant::Constant);
                directional => Directional(directional::Directional);
                envmap => Environment(envmap::EnvironmentMap);
                point => Point(point::Point);
                projector => Projector(projector::Projector);
                spot => Spot(spot::Spot);
                sunsky => SunSky(Box<sunsky::SunSky>);
            }
            shapes {
                area => Area(area::Area);
                directionalarea => DirectionalArea(directionalarea::DirectionalArea);
            }
        }
    };
}

/// The scene as its emitters see it.
pub trait SceneView {
    /// A shape.
    fn shape(&self, id: ShapeId) -> &Shape;

    /// All textures.
    fn textures(&self) -> Textures<'_>;

    /// The bounds of the scene.
    fn bounds(&self) -> Bounds3;
}

/// The interface of an emitter plugin; see the module's contract.
pub(crate) trait Light {
    /// Whether rays that leave the scene find this emitter. False for emitters within the scene.
    fn is_environment(&self) -> bool {
        false
    }

    /// Whether its light is negative in some channel: a colour beyond the primaries of BT.709.
    fn is_out_of_gamut(&self) -> bool {
        false
    }

    /// See [`Emitter::is_delta`].
    fn is_delta(&self) -> bool {
        false
    }

    /// See [`Emitter::sample_direction`].
    fn sample_direction(
        &self,
        scene: &impl SceneView,
        reference: Vec3,
        random: Vec2,
    ) -> Option<DirectionSample>;

    /// See [`Emitter::pdf_direction`]; zero for emitters that rays cannot hit.
    fn pdf_direction(
        &self,
        _scene: &impl SceneView,
        _reference: Vec3,
        _direction: Vec3,
        _surface: Option<&SurfaceInteraction>,
    ) -> f32 {
        0.0
    }

    /// See [`Emitter::surface_radiance`]; zero for emitters without a shape.
    fn surface_radiance(&self, _scene: &impl SceneView, _surface: &SurfaceInteraction) -> Spectrum {
        Spectrum::ZERO
    }

    /// See [`Emitter::distant_radiance`]; zero for emitters within the scene.
    fn distant_radiance(&self, _direction: Vec3) -> Spectrum {
        Spectrum::ZERO
    }

    /// See [`Emitter::sample_ray`].
    fn sample_ray(&self, scene: &impl SceneView, place: Vec2, direction: Vec2)
    -> Option<RaySample>;

    /// Whether it is certain that there is no light. Textures are not looked at.
    fn is_black(&self) -> bool;

    /// How lanes sample this emitter; one by one by default.
    fn in_lanes(&self, _shapes: &[Shape]) -> LaneEmitter {
        LaneEmitter::Single
    }
}

/// Generates the enum of emitters, its dispatch and the registry from the list.
macro_rules! emitters {
    (
        free { $($module:ident => $name:ident($type:ty);)* }
        shapes { $($nested_module:ident => $nested:ident($nested_type:ty);)* }
    ) => {
        /// An emitter of the scene.
        #[derive(Clone, Debug)]
        pub enum Emitter {
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $name($type),)*
            $(#[doc = concat!("See [`", stringify!($nested_module), "`].")]
            $nested($nested_type),)*
        }

        /// All emitters that are not nested in a shape.
        pub static EMITTERS: &[Plugin<BuildEmitter>] = &[
            $(plugin(stringify!($module), &$module::MANUAL, |builder, parameters| {
                $module::build(builder, parameters).map(|light| Emitter::$name(light.into()))
            }),)*
        ];

        /// All emitters that are nested in a shape.
        pub static SHAPE_EMITTERS: &[Plugin<BuildShapeEmitter>] = &[
            $(plugin(stringify!($nested_module), &$nested_module::MANUAL, |builder, parameters, shape| {
                Emitter::$nested($nested_module::build(builder, parameters, shape))
            }),)*
        ];

        /// Runs `$work` with the [`Light`] of an emitter.
        macro_rules! with_light {
            ($emitter:expr, $light:ident => $work:expr) => {
                match $emitter {
                    $(Emitter::$name($light) => $work,)*
                    $(Emitter::$nested($light) => $work,)*
                }
            };
        }

        impl Emitter {
            /// The XML `type` of the emitter.
            #[must_use]
            pub fn kind(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => stringify!($module),)*
                    $(Self::$nested(_) => stringify!($nested_module),)*
                }
            }
        }
    };
}

#[cfg(test)]
pub(crate) use emitter_list;

emitter_list!(emitters);

/// Builds an emitter that is not nested in a shape.
pub type BuildEmitter = fn(&mut Builder<'_>, &Parameters<'_>) -> Option<Emitter>;
/// Builds the emitter of a shape.
pub type BuildShapeEmitter = fn(&mut Builder<'_>, &Parameters<'_>, ShapeId) -> Emitter;

pub(crate) const SAMPLING_WEIGHT: ParameterManual = parameter(
    "sampling_weight",
    "float",
    "1",
    "How often the light is sampled, relative to the others; at 0 only rays that happen to hit it find it.",
);

/// Reads the sampling weight of an emitter, relative to the others.
pub(crate) fn read_sampling_weight(parameters: &Parameters<'_>) -> f32 {
    parameters.float_in("sampling_weight", 1.0, 0.0..=1e6) as f32
}

/// The end of a shadow ray.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// A point, on a surface with this normal or free in space (zero normal).
    Point {
        /// The point.
        point: Vec3,
        /// A bound on the absolute error of each coordinate of `point`.
        error: Vec3,
        /// The unit geometric normal, or zero.
        normal: Vec3,
    },
    /// Infinity.
    Afar,
}

/// Light that may arrive at a point.
#[derive(Clone, Copy, Debug)]
pub struct DirectionSample {
    /// The unit direction from the reference point towards the light.
    pub direction: Vec3,
    /// The unoccluded radiance; for delta emitters, irradiance on a surface that faces the light.
    pub radiance: Spectrum,
    /// The density in solid angle; 1 for delta emitters.
    pub pdf: f32,
    /// Whether only emitter sampling can find the light.
    pub delta: bool,
    /// The end of the shadow ray.
    pub target: Target,
}

/// A ray that leaves an emitter.
#[derive(Clone, Copy, Debug)]
pub struct RaySample {
    /// The path of the light; its direction is unit.
    pub ray: Ray,
    /// The power of the ray: radiance times cosine, divided by its density.
    pub power: Spectrum,
}

/// What lanes can sample of an emitter.
#[derive(Debug)]
pub(crate) enum LaneEmitter {
    /// A parallelogram of constant radiance.
    Parallelogram(ParallelogramLight<f32>),
    /// An environment of constant radiance.
    ConstantEnvironment(Spectrum),
    /// A mesh of constant radiance, whose triangles are sampled by area.
    Mesh(ShapeId, Spectrum),
    /// Nothing: the emitter is sampled one lane at a time.
    Single,
}

impl DirectionSample {
    /// The rest of the way to the light from a point on it; the ray's direction is unit.
    #[inline]
    #[must_use]
    pub fn shadow_ray_from(&self, origin: Vec3) -> Ray {
        match self.target {
            Target::Afar => Ray::new(origin, self.direction),
            Target::Point { point, error, normal } => {
                let target = offset_ray_origin(point, error, normal, -self.direction);
                let path = target - origin;
                let length = path.length();
                if path.dot(self.direction) <= 0.0 {
                    // The point lies beyond the light.
                    return Ray::segment(origin, self.direction, 0.0);
                }
                Ray::segment(origin, path / length, length * SHADOW_RAY_LENGTH)
            }
        }
    }

    /// The shadow ray from a surface to the light.
    #[inline(always)]
    #[must_use]
    pub fn shadow_ray(&self, surface: &SurfaceInteraction) -> Ray {
        match self.target {
            Target::Afar => surface.spawn_ray(self.direction),
            Target::Point { point, error, normal } => {
                let target = offset_ray_origin(point, error, normal, -self.direction);
                let origin =
                    offset_ray_origin(surface.point, surface.error, surface.normal, self.direction);
                shadow_segment(origin.into(), target.into()).into()
            }
        }
    }
}

impl Emitter {
    /// Samples a direction from which light may reach `reference`; `None` if there is none.
    #[inline(always)]
    #[must_use]
    pub fn sample_direction(
        &self,
        scene: &impl SceneView,
        reference: Vec3,
        random: Vec2,
    ) -> Option<DirectionSample> {
        with_light!(self, light => light.sample_direction(scene, reference, random))
    }

    /// The density in solid angle with which [`Self::sample_direction`] samples `direction`.
    /// `surface` is the hit on the emitter's shape, if it has one.
    #[inline]
    #[must_use]
    pub fn pdf_direction(
        &self,
        scene: &impl SceneView,
        reference: Vec3,
        direction: Vec3,
        surface: Option<&SurfaceInteraction>,
    ) -> f32 {
        with_light!(self, light => light.pdf_direction(scene, reference, direction, surface))
    }

    /// The radiance from a point of the emitter's shape towards `surface.wi`.
    #[inline]
    #[must_use]
    pub fn surface_radiance(
        &self,
        scene: &impl SceneView,
        surface: &SurfaceInteraction,
    ) -> Spectrum {
        with_light!(self, light => light.surface_radiance(scene, surface))
    }

    /// The radiance from infinity in the world direction `direction` (pointing outwards).
    #[inline]
    #[must_use]
    pub fn distant_radiance(&self, direction: Vec3) -> Spectrum {
        with_light!(self, light => light.distant_radiance(direction))
    }

    /// Samples a ray that leaves the emitter, from two random numbers for its origin and two for
    /// its direction; `None` if it carries no light.
    ///
    /// The expected power is the total power of the emitter. For emitters at infinity, it is the
    /// power that enters the bounding sphere of the scene.
    #[must_use]
    pub fn sample_ray(
        &self,
        scene: &impl SceneView,
        place: Vec2,
        direction: Vec2,
    ) -> Option<RaySample> {
        with_light!(self, light => light.sample_ray(scene, place, direction))
    }

    /// Whether rays that leave the scene find this emitter.
    #[must_use]
    pub fn is_environment(&self) -> bool {
        with_light!(self, light => light.is_environment())
    }

    /// Whether its light is negative in some channel: a colour beyond the primaries of BT.709.
    #[must_use]
    pub fn is_out_of_gamut(&self) -> bool {
        with_light!(self, light => light.is_out_of_gamut())
    }

    /// Whether it is certain that the emitter has no light.
    #[must_use]
    pub fn is_black(&self) -> bool {
        with_light!(self, light => light.is_black())
    }

    /// Whether only emitter sampling finds the light: rays cannot hit it.
    #[must_use]
    pub fn is_delta(&self) -> bool {
        with_light!(self, light => light.is_delta())
    }

    /// How lanes sample this emitter.
    pub(crate) fn in_lanes(&self, shapes: &[Shape]) -> LaneEmitter {
        with_light!(self, light => light.in_lanes(shapes))
    }
}

/// Rays from infinity start on a bounding sphere enlarged by this factor.
const MARGIN: f32 = 1.0 + 1e-3;

/// A ray that arrives from the direction `towards_light` through a disk as large as the bounding
/// sphere of the scene. `irradiance` is that of a surface facing the light, divided by the density
/// of the direction.
pub(crate) fn ray_from_afar(
    scene: &impl SceneView,
    towards_light: Vec3,
    irradiance: Spectrum,
    place: Vec2,
) -> Option<RaySample> {
    let bounds = scene.bounds();
    if bounds.is_empty() {
        return None;
    }
    let (centre, radius) = bounds.bounding_sphere();
    let radius = radius * MARGIN;
    let disk = warp::concentric_disk::sample(place) * radius;
    let frame = Frame::from_normal(towards_light);
    let origin = centre + frame.to_world(disk.extend(radius));
    let power = irradiance * (PI * radius * radius);
    (power.is_finite() && !power.is_black())
        .then_some(RaySample { ray: Ray::new(origin, -towards_light), power })
}

/// A ray from an emitter that looks the same from every point, in a direction that it samples.
fn sample_ray_from_afar(
    light: &impl Light,
    scene: &impl SceneView,
    place: Vec2,
    direction: Vec2,
) -> Option<RaySample> {
    let sample = light.sample_direction(scene, Vec3::ZERO, direction)?;
    ray_from_afar(scene, sample.direction, sample.radiance / sample.pdf, place)
}
