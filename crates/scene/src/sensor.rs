//! Sensors: from a film position to a ray into the scene.
//!
//! # Contract
//! - A film position covers the whole film, whatever its crop: (0, 0) is the top left corner, (1,
//!   1) the bottom right one.
//! - Camera space is Mitsuba's: the view direction is +z, +y is up, and +x is to the *left*.
//! - Rays are in world space with unit directions. They start at the near plane and end at the far
//!   plane.
//! - `to_world` may scale: distances and the aperture are then in the camera's units.

pub mod batch;
pub mod distant;
pub mod irradiancemeter;
pub mod orthographic;
pub mod perspective;
pub mod radiancemeter;
pub mod spherical;
pub mod thinlens;

pub use crate::models::connection::Connection;
pub use crate::models::image_plane::SensorCommon;

use crate::builder::Builder;
use crate::film::FilmSpec;
use crate::inputs::transform::read_transform;
use crate::manual::{ParameterManual, parameter};
use crate::plugin::{Plugin, plugin};
use crate::shape::Geometry;
use etendue_document::{Fault, Parameters};
use etendue_math::lanes::Level;
use etendue_math::{Bounds3, Ray, Transform, with_lanes};
use glam::{DMat4, DVec3, Mat4, Vec2, Vec3};

/// The list of sensors, one line per plugin: its XML `type`, which is also its module, and the
/// [`SensorModel`] that the scene stores. Those of `shapes` are nested in a shape.
macro_rules! sensor_list {
    ($macro:ident) => {
        $macro! {
            free {
                batch => Batch(batch::Batch);
                distant => Distant(Box<distant::Distant>);
                orthographic => Orthographic(orthographic::Orthographic);
                perspective => Perspective(perspective::Perspective);
                radiancemeter => Radiancemeter(radiancemeter::Radiancemeter);
                spherical => Spherical(spherical::Spherical);
                thinlens => ThinLens(thinlens::ThinLens);
            }
            shapes {
                irradiancemeter => Irradiancemeter(Box<irradiancemeter::Irradiancemeter>);
            }
        }
    };
}

/// The interface of a sensor plugin; see the module's contract.
pub(crate) trait SensorModel {
    /// The settings that all sensors have.
    fn common(&self) -> &SensorCommon;

    /// See [`Sensor::has_lens`]; no lens by default.
    fn has_lens(&self) -> bool {
        false
    }

    /// See [`Sensor::sample_ray`]; `None` if there is no ray.
    fn sample_ray(&self, film_position: Vec2, aperture: Vec2) -> Option<SensorRay>;

    /// See [`Sensor::connect`]; `None` for sensors that particles cannot connect to.
    fn connect(&self, _point: Vec3, _aperture: Vec2) -> Option<Connection> {
        None
    }

    /// Maps camera space to the film; z is 0 at the near plane and 1 at the far plane. The identity
    /// for sensors without a perspective or orthographic image.
    fn projection(&self) -> DMat4 {
        DMat4::IDENTITY
    }

    /// Gives the bounds of the scene to sensors that view all of it.
    fn set_bounds(&mut self, _bounds: &Bounds3) {}
}

/// Generates the enum of sensors, its dispatch and the registry from the list.
macro_rules! sensors {
    (
        free { $($module:ident => $name:ident($type:ty);)* }
        shapes { $($nested_module:ident => $nested:ident($nested_type:ty);)* }
    ) => {
        /// A sensor of the scene.
        #[derive(Clone, Debug)]
        pub enum Sensor {
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $name($type),)*
            $(#[doc = concat!("See [`", stringify!($nested_module), "`].")]
            $nested($nested_type),)*
        }

        /// All sensors that are not nested in a shape.
        pub static SENSORS: &[Plugin<BuildSensor>] = &[
            $(plugin(stringify!($module), &$module::MANUAL, |builder, parameters, film| {
                let sensor = $module::build(builder, parameters, film)?;
                Some(Sensor::$name(sensor.into()))
            }),)*
        ];

        /// All sensors that are nested in a shape.
        pub static SHAPE_SENSORS: &[Plugin<BuildShapeSensor>] = &[
            $(plugin(stringify!($nested_module), &$nested_module::MANUAL, |parameters, film, shape| {
                let sensor = $nested_module::build(parameters, film, shape)?;
                Some(Sensor::$nested(sensor.into()))
            }),)*
        ];

        /// Runs `$work` with the [`SensorModel`] of a sensor.
        macro_rules! with_sensor {
            ($sensor:expr, $model:ident => $work:expr) => {
                match $sensor {
                    $(Sensor::$name($model) => $work,)*
                    $(Sensor::$nested($model) => $work,)*
                }
            };
        }
    };
}

sensor_list!(sensors);

/// Builds a sensor for a film.
pub type BuildSensor = fn(&mut Builder<'_>, &Parameters<'_>, &FilmSpec) -> Option<Sensor>;
/// Builds the sensor of a shape for a film.
pub type BuildShapeSensor = fn(&Parameters<'_>, &FilmSpec, &Geometry) -> Option<Sensor>;

/// A sampled ray of a sensor.
#[derive(Clone, Copy, Debug)]
pub struct SensorRay {
    /// From the near to the far plane.
    pub ray: Ray,
    /// The weight of its radiance.
    pub weight: f32,
}

/// A camera as file headers describe it. Both matrices act on column vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraMatrices {
    /// World to RenderMan's camera space, as OpenEXR's `worldToCamera`: left-handed, +x to the
    /// right, +y up, view direction +z.
    pub world_to_camera: Mat4,
    /// World to the film, as OpenEXR's `worldToNDC`: after division by w, (0, 0) is the top left
    /// corner and (1, 1) the bottom right one; z is 0 at the near plane and 1 at the far plane.
    pub world_to_ndc: Mat4,
}

impl Sensor {
    /// Whether rays start at different points of a lens, so that `aperture` matters.
    #[inline]
    #[must_use]
    pub fn has_lens(&self) -> bool {
        with_sensor!(self, sensor => sensor.has_lens())
    }

    /// The ray from a film position through a point of the aperture. `aperture` is uniform in [0,
    /// 1)².
    #[inline]
    #[must_use]
    pub fn sample_ray(&self, film_position: Vec2, aperture: Vec2) -> SensorRay {
        let ray = with_sensor!(self, sensor => sensor.sample_ray(film_position, aperture));
        // A shape without area yields rays of weight zero.
        ray.unwrap_or(SensorRay { ray: Ray::segment(Vec3::ZERO, Vec3::Z, 0.0), weight: 0.0 })
    }

    /// Appends [`Self::sample_ray`] of each film position with its point of the aperture. `level`
    /// selects the instructions.
    pub fn sample_rays(
        &self,
        level: Level,
        (film_positions, apertures): (&[Vec2], &[Vec2]),
        sensor_rays: &mut Vec<SensorRay>,
    ) {
        if let Self::Perspective(sensor) = self {
            let mut rays = Vec::with_capacity(film_positions.len());
            with_lanes!(level, simd => sensor.rays(simd, film_positions, &mut rays));
            sensor_rays.extend(rays.into_iter().map(|ray| SensorRay { ray, weight: 1.0 }));
            return;
        }
        let places = film_positions.iter().zip(apertures);
        sensor_rays.extend(places.map(|(&place, &aperture)| self.sample_ray(place, aperture)));
    }

    /// Gives the bounds of the scene to sensors that view all of it.
    pub(crate) fn set_bounds(&mut self, bounds: &Bounds3) {
        with_sensor!(self, sensor => sensor.set_bounds(bounds));
    }

    /// The settings that all sensors have.
    #[must_use]
    pub fn common(&self) -> &SensorCommon {
        with_sensor!(self, sensor => sensor.common())
    }

    /// Projects the world point `point` onto the film through a point of the aperture. `aperture`
    /// is uniform in [0, 1)². `None` if the point is not visible on the film, or if particles
    /// cannot connect to the sensor.
    #[must_use]
    pub fn connect(&self, point: Vec3, aperture: Vec2) -> Option<Connection> {
        let connection = with_sensor!(self, sensor => sensor.connect(point, aperture))?;
        let is_finite = connection.importance.is_finite() && connection.film_position.is_finite();
        is_finite.then_some(connection)
    }

    /// The camera as file headers describe it. A lens is described by its centre.
    #[must_use]
    pub fn camera_matrices(&self) -> CameraMatrices {
        let projection = with_sensor!(self, sensor => sensor.projection());
        let camera = Mat4::from(self.common().to_world.inverse_affine()).as_dmat4();
        let mirror = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        CameraMatrices {
            world_to_camera: (mirror * camera).as_mat4(),
            world_to_ndc: (projection * camera).as_mat4(),
        }
    }
}

const TO_WORLD: ParameterManual =
    parameter("to_world", "transform", "", "Camera to world, usually a `lookat`.");
const NEAR_CLIP: ParameterManual =
    parameter("near_clip", "float", "0.01", "Nothing nearer is seen; along the view, from 0 on.");
const FAR_CLIP: ParameterManual =
    parameter("far_clip", "float", "10000", "Nothing beyond is seen; along the view.");
const SHUTTER_OPEN: ParameterManual =
    parameter("shutter_open", "float", "0", "When the shutter opens. Motion is not supported.");
const SHUTTER_CLOSE: ParameterManual =
    parameter("shutter_close", "float", "0", "When the shutter closes.");
const SRF: ParameterManual = parameter(
    "srf",
    "spectrum",
    "",
    "Accepted and without effect: the response of a sensor to wavelengths, where there are but three \
     colours.",
);
const FILM: ParameterManual =
    parameter("(nested)", "film", "hdrfilm", "What the picture is kept on.");
const SAMPLER: ParameterManual =
    parameter("(nested)", "sampler", "independent", "Where random numbers come from.");

/// The greatest distance or time. Its square is still finite in single precision.
const MAX_VALUE: f64 = 1e18;
/// Smaller differences between scales are rounding.
const UNEQUAL_SCALE: f64 = 1e-3;

impl SensorCommon {
    /// Reads the settings of all sensors; `None` after an error has been reported.
    fn read(parameters: &Parameters<'_>) -> Option<Self> {
        let to_world = read_transform(parameters, "to_world");
        let common = Self {
            to_world: to_world.unwrap_or_default(),
            near_clip: parameters.float_in("near_clip", 0.01, 0.0..=MAX_VALUE) as f32,
            far_clip: parameters.float_in("far_clip", 1e4, 0.0..=MAX_VALUE) as f32,
            ..Self::read_shutter(parameters)
        };
        if common.near_clip >= common.far_clip {
            let message = format!(
                "the near plane at {} is not before the far plane at {}",
                common.near_clip, common.far_clip
            );
            parameters.error(Fault::BadValue, "near_clip", message);
            return None;
        }
        (common.check_shutter(parameters) && to_world.is_some()).then_some(common)
    }

    /// The settings of sensors without near and far planes.
    fn without_planes(parameters: &Parameters<'_>, to_world: Transform) -> Option<Self> {
        let common = Self { to_world, ..Self::read_shutter(parameters) };
        common.check_shutter(parameters).then_some(common)
    }

    fn read_shutter(parameters: &Parameters<'_>) -> Self {
        let _ = (parameters.value("srf"), parameters.child("srf"));
        let time = |name| parameters.float_in(name, 0.0, -MAX_VALUE..=MAX_VALUE) as f32;
        Self {
            to_world: Transform::IDENTITY,
            near_clip: 0.0,
            far_clip: f32::INFINITY,
            shutter_open: time("shutter_open"),
            shutter_close: time("shutter_close"),
        }
    }

    fn check_shutter(&self, parameters: &Parameters<'_>) -> bool {
        let is_well = self.shutter_open <= self.shutter_close;
        if !is_well {
            let message = "the shutter closes before it opens";
            parameters.error(Fault::BadValue, "shutter_close", message);
        }
        is_well
    }

    /// Warns if the camera's image is stretched.
    fn warn_of_unequal_scale(&self, parameters: &Parameters<'_>) {
        let matrix = self.matrix();
        let lengths = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::length);
        let lengths = DVec3::from_array(lengths);
        if lengths.max_element() > lengths.min_element() * (1.0 + UNEQUAL_SCALE) {
            let message = "the camera's `to_world` scales unequally, which stretches the picture";
            parameters.warning(Fault::BadValue, "to_world", message);
        }
    }
}

/// Reads the placement of a sensor that looks along one direction. This is `to_world`, or a
/// direction and a point; the parameter `origin` names the point, unless it is empty. `None` after
/// an error has been reported.
fn read_view(parameters: &Parameters<'_>, origin: &str) -> Option<Transform> {
    let to_world = read_transform(parameters, "to_world");
    let direction = parameters.optional_vector("direction");
    let origin = if origin.is_empty() { None } else { parameters.optional_point(origin) };
    if direction.is_none() && origin.is_none() {
        return to_world;
    }
    if parameters.has("to_world") {
        let message = "`to_world` and `direction` say the same thing: give one of them";
        parameters.error(Fault::BadValue, "to_world", message);
        return None;
    }
    let Some(direction) = direction.and_then(DVec3::try_normalize) else {
        parameters.error(Fault::BadValue, "direction", "a direction with a length is needed");
        return None;
    };
    let left = direction.any_orthonormal_vector();
    let axes = [left, direction.cross(left), direction].map(|axis| axis.extend(0.0));
    let origin = origin.unwrap_or(DVec3::ZERO).extend(1.0);
    Transform::from_matrix(&DMat4::from_cols(axes[0], axes[1], axes[2], origin))
}

/// Warns if a sensor that measures a single number has a film of more than one pixel.
fn warn_of_pixels(parameters: &Parameters<'_>, film: &FilmSpec) {
    if (film.width, film.height) != (1, 1) {
        let message = "this sensor measures one number, which every pixel will show: give its film \
                       one pixel";
        parameters.warning(Fault::BadValue, "film", message);
    }
}

#[cfg(test)]
mod tests;
