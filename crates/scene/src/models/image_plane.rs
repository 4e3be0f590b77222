//! The image plane in front of a pinhole, in world space.

use super::connection::Connection;
use etendue_math::Transform;
use etendue_math::lanes::{Real, Vector2, Vector3};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4, Mat3, Vec2, Vec3};

/// The parameters shared by all sensors.
#[derive(Clone, Copy, Debug)]
pub struct SensorCommon {
    /// Camera to world.
    pub to_world: Transform,
    /// The distance along the camera's z axis at which rays start.
    pub near_clip: f32,
    /// The distance along the camera's z axis at which rays end.
    pub far_clip: f32,
    /// When the shutter opens.
    pub shutter_open: f32,
    /// When the shutter closes; not before it opens. Motion is not supported.
    pub shutter_close: f32,
}

impl SensorCommon {
    /// The connection of a point with an origin on the lens, from the point's distance along the
    /// view in camera space and the result of [`pinhole`](super::connection::pinhole).
    pub(crate) fn connection(
        &self,
        point: Vec3,
        (origin, depth): (Vec3, f32),
        (film_position, importance): (Vec2, f32),
    ) -> Option<Connection> {
        if !(self.near_clip..=self.far_clip).contains(&depth) {
            return None;
        }
        let path = origin - point;
        let distance = path.length();
        Some(Connection {
            film_position,
            direction: path / distance,
            distance: distance * (1.0 - self.near_clip / depth),
            importance: importance / (distance * distance),
        })
    }

    /// The linear part of camera to world.
    pub(crate) fn matrix(&self) -> DMat3 {
        Mat3::from(self.to_world.affine().matrix3).as_dmat3()
    }
}

/// The view of a pinhole camera, given by the film's extent at distance one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    /// Half the width and half the height of the film at distance one.
    pub(crate) half_size: DVec2,
    /// The shift of the view as a fraction of the film's size. Positive values move the view right
    /// and down.
    pub(crate) shift: DVec2,
}

impl View {
    /// The film position of a point, and the importance of a path to it: the inverse of generating
    /// a camera ray. `path` leads from the lens to the point in camera space, `focus` to its image
    /// at distance one.
    ///
    /// The film's unit square covers A = 4·halfwidth·halfheight at distance one. A solid angle dω
    /// at an angle θ from the axis covers the fraction dω / (A cos³θ) of it. A power I per solid
    /// angle at a distance r adds a radiance of I/r² over that fraction.
    pub(crate) fn film_point(&self, path: Vec3, focus: Vec2) -> Option<(Vec2, f32)> {
        let half_size = self.half_size.as_vec2();
        let place = (Vec2::ONE - focus / half_size) * 0.5 - self.shift.as_vec2();
        let cosine = path.z / path.length();
        let area = 4.0 * half_size.x * half_size.y;
        (path.z > 0.0).then(|| (place, 1.0 / (area * cosine.powi(3))))
    }

    /// The camera-space direction to a film position, at z = 1.
    fn direction(&self, film_position: DVec2) -> DVec3 {
        (self.half_size * (1.0 - 2.0 * (film_position + self.shift))).extend(1.0)
    }

    /// The projection from camera space to the film. After division by w, x and y are the film
    /// position, and z is 0 at the near plane and 1 at the far plane.
    pub(crate) fn projection(&self, common: &SensorCommon) -> DMat4 {
        let (near, far) = (f64::from(common.near_clip), f64::from(common.far_clip));
        let scale = -0.5 / self.half_size;
        let centre = 0.5 - self.shift;
        DMat4::from_cols(
            DVec4::new(scale.x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, scale.y, 0.0, 0.0),
            DVec4::new(centre.x, centre.y, far / (far - near), 1.0),
            DVec4::new(0.0, 0.0, -near * far / (far - near), 0.0),
        )
    }
}

/// A [`View`] in world space. Vectors are divided by the scale of the camera's z axis, which keeps
/// them in range for any scale; `near` and `length` compensate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImagePlane {
    corner: Vec3,
    across: Vec3,
    down: Vec3,
    /// The distance to the near plane and the distance from it to the far plane, in world units
    /// along the view.
    pub(crate) near: f32,
    pub(crate) length: f32,
}

impl ImagePlane {
    pub(crate) fn new(view: &View, common: &SensorCommon) -> Self {
        let matrix = common.matrix();
        let scale = matrix.z_axis.length();
        let world = |camera: DVec3| (matrix * camera / scale).as_vec3();
        let corner = view.direction(DVec2::ZERO);
        Self {
            corner: world(corner),
            across: world(view.direction(DVec2::X) - corner),
            down: world(view.direction(DVec2::Y) - corner),
            near: (f64::from(common.near_clip) * scale) as f32,
            length: ((f64::from(common.far_clip) - f64::from(common.near_clip)) * scale) as f32,
        }
    }

    /// The world direction to a film position, with unit length along the view.
    #[inline]
    pub(crate) fn direction(&self, film_position: Vec2) -> Vec3 {
        self.direction_lanes::<f32>(film_position.into()).into()
    }

    /// As [`Self::direction`], over any [`Real`].
    #[inline(always)]
    pub(crate) fn direction_lanes<R: Real>(&self, film_position: Vector2<R>) -> Vector3<R> {
        let Vector2 { x, y } = film_position;
        Vector3::like(x, self.corner)
            + Vector3::like(x, self.across) * x
            + Vector3::like(y, self.down) * y
    }
}
