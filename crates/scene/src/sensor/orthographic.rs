//! `orthographic`: a camera with parallel rays.

use super::{
    Connection, FAR_CLIP, FILM, NEAR_CLIP, SAMPLER, SHUTTER_CLOSE, SHUTTER_OPEN, SRF, SensorCommon,
    SensorModel, SensorRay, TO_WORLD,
};
use crate::builder::Builder;
use crate::film::FilmSpec;
use crate::manual::Manual;
use etendue_document::Parameters;
use etendue_math::Ray;
use glam::{DMat4, DVec3, DVec4, Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A camera without perspective. It sees the square from -1 to 1 along its x axis, and \
              as much along y as the film's shape asks for; `to_world` with a scale sees more.",
    parameters: &[TO_WORLD, NEAR_CLIP, FAR_CLIP, SHUTTER_OPEN, SHUTTER_CLOSE, SRF, FILM, SAMPLER],
    sample: r#"<sensor type="orthographic">
    <transform name="to_world">
        <scale x="3" y="3"/>
        <lookat origin="0, 1, 6" target="0, 1, 0" up="0, 1, 0"/>
    </transform>
</sensor>"#,
};

/// A camera with parallel rays.
#[derive(Clone, Copy, Debug)]
pub struct Orthographic {
    pub(crate) common: SensorCommon,
    /// Width over height of the film.
    aspect: f64,
    /// The top left corner of the near plane, and its horizontal and vertical edges.
    corner: Vec3,
    across: Vec3,
    down: Vec3,
    direction: Vec3,
    /// From the near to the far plane, in world units.
    length: f32,
}

/// Reads the sensor.
#[must_use]
pub fn build(
    _builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    film: &FilmSpec,
) -> Option<Orthographic> {
    Some(Orthographic::new(SensorCommon::read(parameters)?, film.aspect()))
}

impl SensorModel for Orthographic {
    fn common(&self) -> &SensorCommon {
        &self.common
    }

    #[inline]
    fn sample_ray(&self, film_position: Vec2, _aperture: Vec2) -> Option<SensorRay> {
        Some(SensorRay { ray: self.ray(film_position), weight: 1.0 })
    }

    /// The inverse of [`Self::ray`]. The importance is one over the area that the film shows.
    fn connect(&self, point: Vec3, _aperture: Vec2) -> Option<Connection> {
        let local = self.common.to_world.inverse_point(point);
        let (near, far) = (self.common.near_clip, self.common.far_clip);
        let film_position =
            Vec2::new(0.5 - 0.5 * local.x, 0.5 - 0.5 * local.y * self.aspect as f32);
        (near..=far).contains(&local.z).then(|| Connection {
            film_position,
            direction: -self.direction,
            distance: (local.z - near) / (far - near) * self.length,
            importance: 1.0 / self.across.cross(self.down).length(),
        })
    }

    /// Maps camera space to the film; z is 0 at the near plane and 1 at the far plane.
    fn projection(&self) -> DMat4 {
        let near = f64::from(self.common.near_clip);
        let depth = f64::from(self.common.far_clip) - near;
        DMat4::from_cols(
            DVec4::new(-0.5, 0.0, 0.0, 0.0),
            DVec4::new(0.0, -0.5 * self.aspect, 0.0, 0.0),
            DVec4::new(0.0, 0.0, 1.0 / depth, 0.0),
            DVec4::new(0.5, 0.5, -near / depth, 1.0),
        )
    }
}

impl Orthographic {
    fn new(common: SensorCommon, aspect: f64) -> Self {
        let matrix = common.matrix();
        let depth = f64::from(common.far_clip) - f64::from(common.near_clip);
        let corner = DVec3::new(1.0, 1.0 / aspect, f64::from(common.near_clip));
        Self {
            common,
            aspect,
            corner: common.to_world.point(Vec3::ZERO) + (matrix * corner).as_vec3(),
            across: (matrix.x_axis * -2.0).as_vec3(),
            down: (matrix.y_axis * (-2.0 / aspect)).as_vec3(),
            direction: matrix.z_axis.normalize().as_vec3(),
            length: (depth * matrix.z_axis.length()) as f32,
        }
    }

    #[inline]
    fn ray(&self, film_position: Vec2) -> Ray {
        let origin = self.corner + self.across * film_position.x + self.down * film_position.y;
        Ray::segment(origin, self.direction, self.length)
    }
}
