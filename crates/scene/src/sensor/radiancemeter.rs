//! `radiancemeter`: the radiance along one ray.

use super::{
    FILM, SAMPLER, SHUTTER_CLOSE, SHUTTER_OPEN, SRF, SensorCommon, SensorModel, SensorRay,
    read_view, warn_of_pixels,
};
use crate::builder::Builder;
use crate::film::FilmSpec;
use crate::manual::{Manual, parameter};
use etendue_document::Parameters;
use etendue_math::Ray;
use glam::{Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Measures the radiance along a single ray: from `origin` along `direction`, or from the \
              origin of `to_world` along its +z. Its film has one pixel.",
    parameters: &[
        parameter("origin", "point", "", "Where the ray starts; with `direction`."),
        parameter("direction", "vector", "", "Where it goes."),
        parameter("to_world", "transform", "", "Placement, instead of the two above."),
        SHUTTER_OPEN,
        SHUTTER_CLOSE,
        SRF,
        FILM,
        SAMPLER,
    ],
    sample: r#"<sensor type="radiancemeter">
    <point name="origin" x="0" y="1" z="6"/>
    <vector name="direction" x="0" y="0" z="-1"/>
    <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/></film>
</sensor>"#,
};

/// Measures the radiance along one ray.
#[derive(Clone, Copy, Debug)]
pub struct Radiancemeter {
    pub(crate) common: SensorCommon,
}

/// Reads the sensor.
#[must_use]
pub fn build(
    _builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    film: &FilmSpec,
) -> Option<Radiancemeter> {
    warn_of_pixels(parameters, film);
    let to_world = read_view(parameters, "origin")?;
    Some(Radiancemeter { common: SensorCommon::without_planes(parameters, to_world)? })
}

impl SensorModel for Radiancemeter {
    fn common(&self) -> &SensorCommon {
        &self.common
    }

    #[cold]
    fn sample_ray(&self, _film_position: Vec2, _aperture: Vec2) -> Option<SensorRay> {
        Some(SensorRay { ray: self.ray(), weight: 1.0 })
    }
}

impl Radiancemeter {
    fn ray(&self) -> Ray {
        let to_world = &self.common.to_world;
        Ray::new(to_world.point(Vec3::ZERO), to_world.vector(Vec3::Z).normalize_or(Vec3::Z))
    }
}
