//! `spherical`: all directions around a point, by longitude and latitude.

use super::{
    FILM, SAMPLER, SHUTTER_CLOSE, SHUTTER_OPEN, SRF, SensorCommon, SensorModel, SensorRay,
};
use crate::builder::Builder;
use crate::film::FilmSpec;
use crate::inputs::transform::read_transform;
use crate::manual::{Manual, parameter};
use etendue_document::Parameters;
use etendue_math::Ray;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A panorama of all directions around the origin of `to_world`, as environment maps are \
              stored: columns are longitudes, rows are latitudes. Its own +y is at the top, and −z on \
              the left and right edges (Mitsuba 0.6).",
    parameters: &[
        parameter("to_world", "transform", "", "Placement."),
        SHUTTER_OPEN,
        SHUTTER_CLOSE,
        SRF,
        FILM,
        SAMPLER,
    ],
    sample: r#"<sensor type="spherical">
    <transform name="to_world"><translate y="1"/></transform>
    <film type="hdrfilm"><integer name="width" value="512"/><integer name="height" value="256"/></film>
</sensor>"#,
};

/// A panorama.
#[derive(Clone, Copy, Debug)]
pub struct Spherical {
    pub(crate) common: SensorCommon,
}

/// Reads the sensor.
#[must_use]
pub fn build(
    _builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    _film: &FilmSpec,
) -> Option<Spherical> {
    let to_world = read_transform(parameters, "to_world")?;
    Some(Spherical { common: SensorCommon::without_planes(parameters, to_world)? })
}

impl SensorModel for Spherical {
    fn common(&self) -> &SensorCommon {
        &self.common
    }

    #[cold]
    fn sample_ray(&self, film_position: Vec2, _aperture: Vec2) -> Option<SensorRay> {
        let (sin_phi, cos_phi) = (TAU * film_position.x).sin_cos();
        let (sin_theta, cos_theta) = (PI * film_position.y).sin_cos();
        let direction = Vec3::new(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta);
        let to_world = &self.common.to_world;
        let direction = to_world.vector(direction).try_normalize()?;
        Some(SensorRay { ray: Ray::new(to_world.point(Vec3::ZERO), direction), weight: 1.0 })
    }
}
