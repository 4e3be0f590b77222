//! `thinlens`: a camera with depth of field.

use super::{
    FAR_CLIP, FILM, MAX_VALUE, NEAR_CLIP, SAMPLER, SHUTTER_CLOSE, SHUTTER_OPEN, SRF, SensorCommon,
    SensorModel, SensorRay, TO_WORLD,
};
use crate::builder::Builder;
use crate::film::FilmSpec;
use crate::inputs::field_of_view::{FOCAL_LENGTH, FOV, FOV_AXIS, read_half_size};
use crate::manual::{Manual, parameter};
use crate::models::connection::Connection;
use crate::models::image_plane::{ImagePlane, View};
use etendue_document::{Fault, Parameters};
use etendue_math::Ray;
use etendue_sampling::warp;
use glam::{DMat4, DVec2, DVec3, Vec2, Vec3};
use std::ops::Bound;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "A camera with a thin lens behind a round aperture: what is not at the focus distance \
              is blurred.",
    parameters: &[
        TO_WORLD,
        parameter(
            "aperture_radius",
            "float",
            "",
            "The radius of the aperture, in scene units; required. Zero is a pinhole.",
        ),
        parameter(
            "focus_distance",
            "float",
            "",
            "The distance along the view that is in focus; `far_clip` by default.",
        ),
        FOV,
        FOV_AXIS,
        FOCAL_LENGTH,
        NEAR_CLIP,
        FAR_CLIP,
        SHUTTER_OPEN,
        SHUTTER_CLOSE,
        SRF,
        FILM,
        SAMPLER,
    ],
    sample: r#"<sensor type="thinlens">
    <float name="aperture_radius" value="0.1"/>
    <float name="focus_distance" value="6"/>
    <transform name="to_world">
        <lookat origin="0, 1, 6" target="0, 1, 0" up="0, 1, 0"/>
    </transform>
</sensor>"#,
};

/// The greatest ratio of the aperture's radius to the focus distance.
const MAX_RATIO: f64 = 1e6;

/// A camera with a thin lens.
#[derive(Clone, Copy, Debug)]
pub struct ThinLens {
    pub(crate) common: SensorCommon,
    view: View,
    lens: Lens,
    centre: Vec3,
    /// The two semi-axes of the aperture in world space.
    aperture: [Vec3; 2],
    /// How much they deflect a ray of unit depth towards the focus.
    tilt: [Vec3; 2],
    plane: ImagePlane,
}

/// Reads the sensor.
#[must_use]
pub fn build(
    _builder: &mut Builder<'_>,
    parameters: &Parameters<'_>,
    film: &FilmSpec,
) -> Option<ThinLens> {
    let common = SensorCommon::read(parameters);
    let half_size = read_half_size(parameters, film.aspect());
    let radius = parameters.float_in("aperture_radius", 0.0, 0.0..=MAX_VALUE);
    if !parameters.has("aperture_radius") {
        let message = "`thinlens` needs the parameter `aperture_radius`";
        parameters.error(Fault::MissingParameter, "aperture_radius", message);
    }
    let far = common.map_or(1.0, |common| f64::from(common.far_clip));
    let range = (Bound::Excluded(0.0), Bound::Included(MAX_VALUE));
    let focus_distance = parameters.float_in("focus_distance", far, range);
    if radius > MAX_RATIO * focus_distance {
        let message = "the focus lies within the aperture, within the precision of the numbers";
        parameters.error(Fault::BadValue, "focus_distance", message);
        return None;
    }
    let (common, half_size) = (common?, half_size?);
    common.warn_of_unequal_scale(parameters);
    let view = View { half_size, shift: DVec2::ZERO };
    Some(ThinLens::new(common, view, Lens { radius, focus_distance }))
}

/// A lens in camera space.
#[derive(Clone, Copy, Debug)]
struct Lens {
    radius: f64,
    focus_distance: f64,
}

impl SensorModel for ThinLens {
    fn common(&self) -> &SensorCommon {
        &self.common
    }

    fn has_lens(&self) -> bool {
        true
    }

    #[inline]
    fn sample_ray(&self, film_position: Vec2, aperture: Vec2) -> Option<SensorRay> {
        Some(SensorRay { ray: self.ray(film_position, aperture), weight: 1.0 })
    }

    /// The inverse of [`Self::ray`].
    fn connect(&self, point: Vec3, aperture: Vec2) -> Option<Connection> {
        let local = self.common.to_world.inverse_point(point);
        let disk = warp::concentric_disk::sample(aperture);
        let lens = (disk * self.lens.radius as f32).extend(0.0);
        let path = local - lens;
        // Where the path meets the plane in focus, divided by the focus distance.
        let focus = lens.truncate() / self.lens.focus_distance as f32 + path.truncate() / path.z;
        let (film_position, importance) = self.view.film_point(path, focus)?;
        let origin = self.centre + self.aperture[0] * disk.x + self.aperture[1] * disk.y;
        self.common.connection(point, (origin, path.z), (film_position, importance))
    }

    fn projection(&self) -> DMat4 {
        self.view.projection(&self.common)
    }
}

impl ThinLens {
    fn new(common: SensorCommon, view: View, lens: Lens) -> Self {
        let matrix = common.matrix();
        let half_axes = [DVec3::X, DVec3::Y].map(|axis| matrix * axis * lens.radius);
        let focus_distance = lens.focus_distance * matrix.z_axis.length();
        Self {
            common,
            view,
            lens,
            centre: common.to_world.point(Vec3::ZERO),
            aperture: half_axes.map(|axis| axis.as_vec3()),
            tilt: half_axes.map(|axis| (axis / focus_distance).as_vec3()),
            plane: ImagePlane::new(&view, &common),
        }
    }

    #[inline]
    fn ray(&self, film_position: Vec2, aperture: Vec2) -> Ray {
        let point = warp::concentric_disk::sample(aperture);
        let from_centre = self.aperture[0] * point.x + self.aperture[1] * point.y;
        // All rays of a film position meet the pinhole ray at the focus distance.
        let tilt = self.tilt[0] * point.x + self.tilt[1] * point.y;
        let direction = self.plane.direction(film_position) - tilt;
        let length = direction.length();
        Ray::segment(
            self.centre + from_centre + direction * self.plane.near,
            direction / length,
            self.plane.length * length,
        )
    }
}
