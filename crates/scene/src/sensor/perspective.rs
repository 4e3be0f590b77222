//! `perspective`: a pinhole camera.

use super::{
    FAR_CLIP, FILM, NEAR_CLIP, SAMPLER, SHUTTER_CLOSE, SHUTTER_OPEN, SRF, SensorCommon,
    SensorModel, SensorRay, TO_WORLD,
};
use crate::builder::Builder;
use crate::film::FilmSpec;
use crate::inputs::field_of_view::{FOCAL_LENGTH, FOV, FOV_AXIS, read_half_size};
use crate::manual::{Manual, parameter};
use crate::models::connection::Connection;
use crate::models::image_plane::{ImagePlane, View};
use etendue_document::Parameters;
use etendue_math::lanes::{Lanes, Real, Simd, Vector2, Vector3};
use etendue_math::{Ray, RayLanes};
use glam::{DMat4, DVec2, Vec2, Vec3};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A pinhole camera: everything is in focus. It looks along +z of its own space, with \
              +y up.",
    parameters: &[
        TO_WORLD,
        FOV,
        FOV_AXIS,
        FOCAL_LENGTH,
        NEAR_CLIP,
        FAR_CLIP,
        parameter(
            "principal_point_offset_x",
            "float",
            "0",
            "Moves the picture to the left, as a share of the film's width.",
        ),
        parameter(
            "principal_point_offset_y",
            "float",
            "0",
            "Moves the picture up, as a share of the film's height.",
        ),
        SHUTTER_OPEN,
        SHUTTER_CLOSE,
        SRF,
        FILM,
        SAMPLER,
    ],
    sample: r#"<sensor type="perspective">
    <float name="fov" value="39.3"/>
    <string name="fov_axis" value="smaller"/>
    <transform name="to_world">
        <lookat origin="0, 1, 6" target="0, 1, 0" up="0, 1, 0"/>
    </transform>
    <film type="hdrfilm"/>
    <sampler type="sobol"/>
</sensor>"#,
};

/// The greatest shift of the principal point, in film sizes.
const MAX_SHIFT: f64 = 1e3;

/// A pinhole camera.
#[derive(Clone, Copy, Debug)]
pub struct Perspective {
    pub(crate) common: SensorCommon,
    view: View,
    origin: Vec3,
    plane: ImagePlane,
}

/// Reads the sensor.
#[must_use]
pub fn build(
    _builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    film: &FilmSpec,
) -> Option<Perspective> {
    let common = SensorCommon::read(parameters);
    let half_size = read_half_size(parameters, film.aspect());
    let shift = DVec2::new(
        parameters.float_in("principal_point_offset_x", 0.0, -MAX_SHIFT..=MAX_SHIFT),
        parameters.float_in("principal_point_offset_y", 0.0, -MAX_SHIFT..=MAX_SHIFT),
    );
    let (common, half_size) = (common?, half_size?);
    common.warn_of_unequal_scale(parameters);
    Some(Perspective::new(common, View { half_size, shift }))
}

impl SensorModel for Perspective {
    fn common(&self) -> &SensorCommon {
        &self.common
    }

    #[inline]
    fn sample_ray(&self, film_position: Vec2, _aperture: Vec2) -> Option<SensorRay> {
        Some(SensorRay { ray: self.ray(film_position), weight: 1.0 })
    }

    /// The inverse of [`Self::ray`].
    fn connect(&self, point: Vec3, _aperture: Vec2) -> Option<Connection> {
        let local = self.common.to_world.inverse_point(point);
        let (film_position, importance) =
            self.view.film_point(local, local.truncate() / local.z)?;
        self.common.connection(point, (self.origin, local.z), (film_position, importance))
    }

    fn projection(&self) -> DMat4 {
        self.view.projection(&self.common)
    }
}

impl Perspective {
    fn new(common: SensorCommon, view: View) -> Self {
        let origin = common.to_world.point(Vec3::ZERO);
        Self { common, view, origin, plane: ImagePlane::new(&view, &common) }
    }

    #[inline]
    fn ray(&self, film_position: Vec2) -> Ray {
        self.ray_lanes::<f32>(film_position.into()).into()
    }

    /// [`Self::ray`] over any [`Real`].
    #[inline(always)]
    fn ray_lanes<R: Real>(&self, film_position: Vector2<R>) -> RayLanes<R> {
        let direction = self.plane.direction_lanes(film_position);
        let length = direction.length();
        let near = length.like(self.plane.near);
        RayLanes {
            origin: Vector3::like(length, self.origin) + direction * near,
            direction: direction.map(
                #[inline(always)]
                |coordinate| coordinate / length,
            ),
            t_max: length * self.plane.length,
        }
    }

    /// Appends [`Self::ray`] of each film position.
    #[inline(always)]
    pub(super) fn rays<S: Simd>(&self, simd: S, film_positions: &[Vec2], rays: &mut Vec<Ray>) {
        for positions in film_positions.chunks(Lanes::<S>::COUNT) {
            let coordinate = |axis: usize| {
                let at = |lane: usize| positions[lane.min(positions.len() - 1)][axis];
                Lanes::from_fn(simd, at)
            };
            let lanes = self.ray_lanes(Vector2::new(coordinate(0), coordinate(1)));
            rays.extend((0..positions.len()).map(|lane| lanes.lane(lane)));
        }
    }
}
