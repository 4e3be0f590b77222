//! `irradiancemeter`: the irradiance on a shape.

use super::{
    FILM, SAMPLER, SHUTTER_CLOSE, SHUTTER_OPEN, SRF, SensorCommon, SensorModel, SensorRay,
    warn_of_pixels,
};
use crate::film::FilmSpec;
use crate::ids::MaterialId;
use crate::manual::Manual;
use crate::shape::{Geometry, Shape};
use etendue_document::Parameters;
use etendue_math::{Frame, Ray, Transform, offset_ray_origin};
use etendue_sampling::warp;
use glam::Vec2;
use std::f32::consts::PI;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Measures the irradiance on the shape that it is nested in, averaged over its front. Its \
              film has one pixel.",
    parameters: &[SHUTTER_OPEN, SHUTTER_CLOSE, SRF, FILM, SAMPLER],
    sample: r#"<shape type="rectangle">
    <sensor type="irradiancemeter">
        <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/></film>
    </sensor>
</shape>"#,
};

/// Measures the irradiance on a shape.
#[derive(Clone, Debug)]
pub struct Irradiancemeter {
    pub(crate) common: SensorCommon,
    /// A copy of the shape's geometry, because sensors have no access to the scene.
    shape: Shape,
}

/// Reads the sensor of a shape.
#[must_use]
pub fn build(
    parameters: &Parameters<'_>,
    film: &FilmSpec,
    geometry: &Geometry,
) -> Option<Irradiancemeter> {
    warn_of_pixels(parameters, film);
    let mut geometry = geometry.clone();
    geometry.prepare_sampling();
    let common = SensorCommon::without_planes(parameters, Transform::IDENTITY)?;
    let shape = Shape { geometry, material: MaterialId(0), emitter: None };
    Some(Irradiancemeter { common, shape })
}

impl SensorModel for Irradiancemeter {
    fn common(&self) -> &SensorCommon {
        &self.common
    }

    fn has_lens(&self) -> bool {
        true
    }

    /// A ray from a uniform point of the shape, with a cosine-weighted direction. Its radiance has
    /// weight π.
    #[cold]
    fn sample_ray(&self, place: Vec2, direction: Vec2) -> Option<SensorRay> {
        let sample = self.shape.sample_area(place - place.floor())?;
        let local = warp::cosine_hemisphere::sample(direction);
        let direction = Frame::from_normal(sample.normal).to_world(local);
        let origin = offset_ray_origin(sample.point, sample.error, sample.normal, direction);
        let weight = PI / (sample.pdf * self.shape.area());
        Some(SensorRay { ray: Ray::new(origin, direction), weight })
    }
}
