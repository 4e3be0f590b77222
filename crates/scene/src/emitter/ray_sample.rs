//! Light on its way out: rays that start at emitters, for tracing particles.

use super::{Emitter, directional, directionalarea, point, projector, spot};
use crate::ids::ShapeId;
use crate::scene::Scene;
use crate::shape::ShapeSample;
use crate::texture::ColorSource;
use etendue_math::{Frame, Ray, offset_ray_origin};
use etendue_sampling::warp;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// A ray that carries light away from an emitter.
#[derive(Clone, Copy, Debug)]
pub struct RaySample {
    /// Where the light goes; its direction is unit.
    pub ray: Ray,
    /// The power that it carries: radiance times cosine over the density of the ray.
    pub power: Spectrum,
}

/// Rays from afar start this far beyond the sphere around the scene, in radii.
const MARGIN: f32 = 1.0 + 1e-3;

impl Emitter {
    /// Chooses a ray that leaves the emitter, from two numbers for its place and two for its
    /// direction; `None` where no light goes.
    ///
    /// The mean of the powers is all that the emitter sends out; from afar, all that enters the
    /// sphere around the scene.
    #[must_use]
    pub fn sample_ray(&self, scene: &Scene, place: Vec2, direction: Vec2) -> Option<RaySample> {
        match self {
            Self::Area(emitter) => {
                let (shape, radiance) = emitter.source();
                shape_leaving(scene, shape, radiance, place, Spread::Cosine(direction))
            }
            Self::DirectionalArea(directionalarea::DirectionalArea { shape, exitance }) => {
                shape_leaving(scene, *shape, *exitance, place, Spread::Ahead)
            }
            Self::Point(emitter) => Some(point_leaving(emitter, direction)),
            Self::Spot(emitter) => spot_leaving(emitter, scene, direction),
            Self::Projector(emitter) => projector_leaving(emitter, scene, direction),
            Self::Directional(emitter) => directional_leaving(emitter, scene, place),
            _ => {
                // What arrives from afar looks the same from everywhere.
                let sample = self.sample_direction(scene, Vec3::ZERO, direction)?;
                from_afar(scene, sample.direction, sample.radiance / sample.pdf, place)
            }
        }
    }
}

/// How light leaves a surface.
enum Spread {
    /// The same radiance in all directions.
    Cosine(Vec2),
    /// Along the normal.
    Ahead,
}

fn shape_leaving(
    scene: &Scene,
    shape: ShapeId,
    color: ColorSource,
    place: Vec2,
    spread: Spread,
) -> Option<RaySample> {
    let sample = scene.shape(shape).sample_area(place)?;
    let ShapeSample { point, error, shading_normal, pdf, .. } = sample;
    // Light leaves the geometric surface, on the side where the shading normal points.
    let front = sample.normal * 1.0_f32.copysign(sample.normal.dot(shading_normal));
    let (direction, share) = match spread {
        Spread::Ahead => (shading_normal, 1.0),
        Spread::Cosine(random) => {
            let local = warp::cosine_hemisphere::sample(random);
            (Frame::from_normal(front).to_world(local), PI)
        }
    };
    if direction.dot(shading_normal) <= 0.0 || pdf <= 0.0 {
        return None;
    }
    let surface = sample.interaction(shape, direction);
    let color = color.eval(scene.textures(), &surface);
    let origin = offset_ray_origin(point, error, sample.normal, direction);
    let leaving = RaySample { ray: Ray::new(origin, direction), power: color * (share / pdf) };
    (!color.is_black()).then_some(leaving)
}

fn point_leaving(emitter: &point::Point, random: Vec2) -> RaySample {
    let direction = warp::uniform_sphere::sample(random);
    RaySample { ray: Ray::new(emitter.position, direction), power: emitter.intensity * (4.0 * PI) }
}

fn spot_leaving(emitter: &spot::Spot, scene: &Scene, random: Vec2) -> Option<RaySample> {
    let cone = warp::uniform_cone::one_minus_cosine(emitter.cutoff_angle);
    let local = warp::uniform_cone::sample(random, cone);
    let intensity = emitter.intensity_towards(scene.textures(), local);
    let direction = emitter.to_world.vector(local).try_normalize()?;
    let origin = emitter.to_world.point(Vec3::ZERO);
    let power = intensity * (2.0 * PI * cone);
    (!power.is_black()).then_some(RaySample { ray: Ray::new(origin, direction), power })
}

/// Places in the picture are uniform. With the picture's area A at distance one, their density in
/// solid angle is 1/(A cos³θ), and the intensity E/cos³θ: what is left is E·A.
fn projector_leaving(
    emitter: &projector::Projector,
    scene: &Scene,
    random: Vec2,
) -> Option<RaySample> {
    let local = ((1.0 - 2.0 * random) * emitter.half_size).extend(1.0);
    let direction = emitter.to_world.vector(local).try_normalize()?;
    let area = 4.0 * emitter.half_size.x * emitter.half_size.y;
    let power = emitter.picture(scene.textures(), random) * area;
    let origin = emitter.to_world.point(Vec3::ZERO);
    (!power.is_black()).then_some(RaySample { ray: Ray::new(origin, direction), power })
}

fn directional_leaving(
    emitter: &directional::Directional,
    scene: &Scene,
    place: Vec2,
) -> Option<RaySample> {
    from_afar(scene, emitter.towards_light, emitter.irradiance, place)
}

/// A ray from the direction `towards_light`, through the disk that the sphere around the scene shows
/// it; `irradiance` is what a surface that faces it gets, over the density of the direction.
fn from_afar(
    scene: &Scene,
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
