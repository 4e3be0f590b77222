//! Emitters: where light comes from.
//!
//! # Contract
//! - [`Emitter::sample_direction`] chooses, seen from a point, where light may come from; its `pdf` is
//!   in solid angle at that point, and 1 for emitters that a ray cannot hit by chance (delta).
//! - [`Emitter::pdf_direction`] is the density with which that would choose a given direction, for
//!   rays that have found the emitter by other means.
//! - Radiance is not divided by the density, and visibility is the caller's business.

pub mod area;
pub mod constant;
pub mod directional;
pub mod directionalarea;
pub mod envmap;
pub mod point;
pub mod projector;
pub mod ray_sample;
pub mod spot;
pub mod sunsky;

pub use crate::lanes::{LightLanes, TargetLanes};

use crate::interaction::SurfaceInteraction;
use crate::lanes::shadow_segment;
use crate::manual::{ParameterManual, parameter};
use crate::scene::Scene;
use etendue_document::Parameters;
use etendue_math::{Ray, offset_ray_origin};
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// An emitter of the scene.
#[derive(Clone, Debug)]
pub enum Emitter {
    /// A shape that glows.
    Area(area::Area),
    /// A point that shines in all directions.
    Point(point::Point),
    /// A point that shines into a cone.
    Spot(spot::Spot),
    /// Parallel light from afar.
    Directional(directional::Directional),
    /// A shape that shines straight ahead only.
    DirectionalArea(directionalarea::DirectionalArea),
    /// A point that throws a picture.
    Projector(projector::Projector),
    /// The same light from everywhere afar.
    Constant(constant::Constant),
    /// A picture of the surroundings.
    Environment(envmap::EnvironmentMap),
    /// The sky and the sun.
    SunSky(Box<sunsky::SunSky>),
}

pub(crate) const SAMPLING_WEIGHT: ParameterManual = parameter(
    "sampling_weight",
    "float",
    "1",
    "How often the light is sampled, relative to the others; 0 leaves it to chance.",
);

/// Reads how often an emitter is sampled, relative to the others.
pub(crate) fn read_sampling_weight(parameters: &Parameters<'_>) -> f32 {
    parameters.float_in("sampling_weight", 1.0, 0.0..=1e6) as f32
}

/// Where a shadow ray goes.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// To a point, on a surface with this normal or free in space (zero normal).
    Point {
        /// The point.
        point: Vec3,
        /// A bound of the absolute error of each coordinate of `point`.
        error: Vec3,
        /// The unit geometric normal, or zero.
        normal: Vec3,
    },
    /// To infinity.
    Afar,
}

/// Light that may arrive at a point.
#[derive(Clone, Copy, Debug)]
pub struct DirectionSample {
    /// The unit direction from the reference point towards the light.
    pub direction: Vec3,
    /// Radiance that would arrive if nothing stood between; for delta emitters, irradiance on a
    /// surface facing the light.
    pub radiance: Spectrum,
    /// The density in solid angle; 1 for delta emitters.
    pub pdf: f32,
    /// Whether only this technique can find the light.
    pub delta: bool,
    /// Where the shadow ray goes.
    pub target: Target,
}

/// Shadow rays to a surface stop short of it by this share of their length: the distance at which
/// the surface itself would be hit is known to a few roundings only.
pub(crate) const SHADOW_RAY_LENGTH: f32 = 1.0 - 2e-5;

impl DirectionSample {
    /// What is left of the way to the light from a point on it; the ray's direction is unit.
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
                    // The light has been passed.
                    return Ray::segment(origin, self.direction, 0.0);
                }
                Ray::segment(origin, path / length, length * SHADOW_RAY_LENGTH)
            }
        }
    }

    /// The ray that must be free for the light to arrive at a surface.
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
    /// Chooses where light may come from, seen from `reference`; `None` where none can.
    #[inline(always)]
    #[must_use]
    pub fn sample_direction(
        &self,
        scene: &Scene,
        reference: Vec3,
        random: Vec2,
    ) -> Option<DirectionSample> {
        match self {
            Self::Area(emitter) => emitter.sample_direction(scene, reference, random),
            Self::Point(emitter) => emitter.sample_direction(reference),
            Self::Spot(emitter) => emitter.sample_direction(scene, reference),
            Self::Directional(emitter) => Some(emitter.sample_direction()),
            Self::DirectionalArea(_) => None,
            Self::Projector(emitter) => emitter.sample_direction(scene, reference),
            Self::Constant(emitter) => Some(emitter.sample_direction(random)),
            Self::Environment(emitter) => emitter.sample_direction(random),
            Self::SunSky(emitter) => emitter.sample_direction(random),
        }
    }

    /// The density in solid angle with which [`Self::sample_direction`] would choose `direction`.
    /// `surface` is where the emitter's shape was hit, if it has one.
    #[inline]
    #[must_use]
    pub fn pdf_direction(
        &self,
        scene: &Scene,
        reference: Vec3,
        direction: Vec3,
        surface: Option<&SurfaceInteraction>,
    ) -> f32 {
        match (self, surface) {
            (Self::Area(emitter), Some(surface)) => {
                emitter.pdf_direction(scene, reference, surface)
            }
            (Self::Constant(emitter), _) => emitter.pdf_direction(),
            (Self::Environment(emitter), _) => emitter.pdf_direction(direction),
            (Self::SunSky(emitter), _) => emitter.pdf_direction(direction),
            _ => 0.0,
        }
    }

    /// The radiance that leaves a point of the emitter's shape towards `surface.wi`.
    #[inline]
    #[must_use]
    pub fn surface_radiance(&self, scene: &Scene, surface: &SurfaceInteraction) -> Spectrum {
        match self {
            Self::Area(emitter) => emitter.radiance(scene, surface),
            _ => Spectrum::ZERO,
        }
    }

    /// The radiance that arrives from afar in the world direction `direction` (pointing outwards).
    #[inline]
    #[must_use]
    pub fn distant_radiance(&self, direction: Vec3) -> Spectrum {
        match self {
            Self::Constant(emitter) => emitter.radiance(),
            Self::Environment(emitter) => emitter.radiance(direction),
            Self::SunSky(emitter) => emitter.radiance(direction),
            _ => Spectrum::ZERO,
        }
    }

    /// Whether rays that leave the scene find this emitter.
    #[must_use]
    pub fn is_environment(&self) -> bool {
        matches!(self, Self::Constant(_) | Self::Environment(_) | Self::SunSky(_))
    }

    /// The name of the emitter's kind.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Area(_) => "area",
            Self::Point(_) => "point",
            Self::Spot(_) => "spot",
            Self::Directional(_) => "directional",
            Self::DirectionalArea(_) => "directionalarea",
            Self::Projector(_) => "projector",
            Self::Constant(_) => "constant",
            Self::Environment(_) => "envmap",
            Self::SunSky(_) => "sunsky",
        }
    }
}
