//! `batch`: several sensors side by side on one film.

use super::{
    FILM, SAMPLER, SHUTTER_CLOSE, SHUTTER_OPEN, SRF, Sensor, SensorCommon, SensorModel, SensorRay,
};
use crate::builder::Builder;
use crate::film::FilmSpec;
use crate::manual::{Manual, parameter};
use etendue_document::{Class, Fault, Parameters};
use etendue_math::{Bounds3, Transform};
use glam::{UVec2, Vec2};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Several sensors, whose pictures lie side by side on one film, from the left. The film's \
              width is a multiple of their number. What the sensors say of films, samplers and shutters \
              does not count.",
    parameters: &[
        parameter("(nested)", "sensor", "", "The sensors, one or more; required."),
        SHUTTER_OPEN,
        SHUTTER_CLOSE,
        SRF,
        FILM,
        SAMPLER,
    ],
    sample: r#"<sensor type="batch">
    <sensor type="perspective"/>
    <sensor type="orthographic"/>
    <film type="hdrfilm"><integer name="width" value="512"/><integer name="height" value="256"/></film>
</sensor>"#,
};

/// Several sensors.
#[derive(Clone, Debug)]
pub struct Batch {
    common: SensorCommon,
    /// At least one, from left to right.
    sensors: Vec<Sensor>,
}

/// Reads the sensors.
#[must_use]
pub fn build(
    builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    film: &FilmSpec,
) -> Option<Batch> {
    let children = parameters.children_of(Class::Sensor);
    let count = children.len() as u32;
    if count == 0 {
        let message = "a batch needs a sensor inside it";
        parameters.error(Fault::MissingParameter, "(nested)", message);
        return None;
    }
    if !film.width.is_multiple_of(count) {
        let message =
            format!("a film {} pixels wide cannot be shared by {count} sensors", film.width);
        parameters.error(Fault::BadValue, "(nested)", message);
        return None;
    }
    let common = SensorCommon::without_planes(parameters, Transform::IDENTITY)?;
    let share = FilmSpec::new(UVec2::new(film.width / count, film.height));
    let sensors: Option<Vec<Sensor>> =
        children.into_iter().map(|child| builder.sensor_on(child.node, &share)).collect();
    Some(Batch { common, sensors: sensors? })
}

impl SensorModel for Batch {
    fn common(&self) -> &SensorCommon {
        &self.common
    }

    fn has_lens(&self) -> bool {
        self.sensors.iter().any(Sensor::has_lens)
    }

    #[cold]
    fn sample_ray(&self, film_position: Vec2, aperture: Vec2) -> Option<SensorRay> {
        let (sensor, film_position) = self.at(film_position)?;
        Some(sensor.sample_ray(film_position, aperture))
    }

    fn set_bounds(&mut self, bounds: &Bounds3) {
        self.sensors.iter_mut().for_each(|sensor| sensor.set_bounds(bounds));
    }
}

impl Batch {
    /// The sensor at a film position, and the position on that sensor's part of the film.
    fn at(&self, film_position: Vec2) -> Option<(&Sensor, Vec2)> {
        let scaled = film_position.x * self.sensors.len() as f32;
        // Samples beyond the film, within the filter's radius, belong to the sensor at the edge.
        let index = (scaled.max(0.0) as usize).min(self.sensors.len() - 1);
        let sensor = self.sensors.get(index)?;
        Some((sensor, Vec2::new(scaled - index as f32, film_position.y)))
    }
}
