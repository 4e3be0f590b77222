//! `distant`: the radiance that leaves the scene in one direction.

use super::{
    FILM, SAMPLER, SHUTTER_CLOSE, SHUTTER_OPEN, SRF, SensorCommon, SensorModel, SensorRay,
    read_view, warn_of_pixels,
};
use crate::builder::Builder;
use crate::film::FilmSpec;
use crate::ids::MaterialId;
use crate::manual::{Manual, parameter};
use crate::plugin::find;
use crate::shape;
use crate::shape::Shape;
use etendue_document::{Class, Fault, Parameters};
use etendue_math::{Bounds3, Frame, Ray};
use etendue_sampling::warp;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Measures the radiance that leaves the scene against `direction`, averaged over a target: \
              all of the scene, as the sphere around it shows, a point, or a shape that is nested in \
              the sensor and no part of the scene. Rays start outside of the scene. Its film has one \
              pixel.",
    parameters: &[
        parameter("direction", "vector", "", "Where the sensor looks."),
        parameter("to_world", "transform", "", "Its +z is where the sensor looks; instead."),
        parameter("target", "point or shape", "", "What it looks at; all of the scene."),
        SHUTTER_OPEN,
        SHUTTER_CLOSE,
        SRF,
        FILM,
        SAMPLER,
    ],
    sample: r#"<sensor type="distant">
    <vector name="direction" x="0" y="-1" z="0"/>
    <point name="target" x="0" y="0" z="0"/>
    <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/></film>
</sensor>"#,
};

/// Measures the radiance that leaves the scene in one direction.
#[derive(Clone, Debug)]
pub struct Distant {
    pub(crate) common: SensorCommon,
    target: Target,
    /// The bounding sphere of the scene.
    centre: Vec3,
    radius: f32,
}

/// The target of the rays.
#[derive(Clone, Debug)]
enum Target {
    Scene,
    Point(Vec3),
    Shape(Box<Shape>),
}

/// Enlarges the bounding sphere, so that rays start outside the scene.
const MARGIN: f32 = 1.0 + 1e-4;

/// Reads the sensor.
#[must_use]
pub fn build(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    film: &FilmSpec,
) -> Option<Distant> {
    warn_of_pixels(parameters, film);
    let target = read_target(builder, parameters)?;
    let to_world = read_view(parameters, "")?;
    let common = SensorCommon::without_planes(parameters, to_world)?;
    Some(Distant { common, target, centre: Vec3::ZERO, radius: 1.0 })
}

fn read_target(builder: &Builder<'_>, parameters: &Parameters<'_>) -> Option<Target> {
    let Some(child) = parameters.child("target") else {
        return Some(match parameters.optional_point("target") {
            Some(point) => Target::Point(point.as_vec3()),
            None => Target::Scene,
        });
    };
    if builder.assets.document.node(child.node).class != Class::Shape {
        parameters.error(Fault::BadValue, "target", "expected a point or a shape");
        return None;
    }
    let shape = builder.parameters(child.node);
    let build = find(shape::SHAPES, &shape)?;
    let mut geometry = build(builder.assets, &shape)?;
    geometry.prepare_sampling();
    let shape = Shape { geometry, material: MaterialId(0), emitter: None };
    Some(Target::Shape(Box::new(shape)))
}

impl SensorModel for Distant {
    fn common(&self) -> &SensorCommon {
        &self.common
    }

    fn has_lens(&self) -> bool {
        true
    }

    #[cold]
    fn sample_ray(&self, _film_position: Vec2, aperture: Vec2) -> Option<SensorRay> {
        let to_world = &self.common.to_world;
        let direction = to_world.vector(Vec3::Z).try_normalize()?;
        let (origin, weight) = match &self.target {
            Target::Point(point) => (*point - direction * (2.0 * self.radius), 1.0),
            Target::Shape(shape) => {
                let sample = shape.sample_area(aperture)?;
                let weight = 1.0 / (sample.pdf * shape.area());
                (sample.point - direction * (2.0 * self.radius), weight)
            }
            Target::Scene => {
                let offset = warp::concentric_disk::sample(aperture).extend(-1.0);
                let frame = Frame::from_normal(direction);
                (self.centre + frame.to_world(offset) * self.radius, 1.0)
            }
        };
        Some(SensorRay { ray: Ray::new(origin, direction), weight })
    }

    /// Sets the bounds of the scene.
    fn set_bounds(&mut self, bounds: &Bounds3) {
        if !bounds.is_empty() {
            let (centre, radius) = bounds.bounding_sphere();
            (self.centre, self.radius) = (centre, radius * MARGIN);
        }
    }
}
