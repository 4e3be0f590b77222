//! From a point of the scene to the film: the sensor seen from there, for tracing particles.

use super::Sensor;
use super::plane::View;
use glam::{Vec2, Vec3};

/// How a point of the scene shows on the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection {
    /// The place on the whole film, which is [0, 1)²; it may lie beyond.
    pub film_position: Vec2,
    /// The unit world direction from the point towards the sensor.
    pub direction: Vec3,
    /// How far the sensor sees from its near plane to the point, in world units.
    pub distance: f32,
    /// What one unit of power per solid angle that leaves the point towards the sensor (of power per
    /// area and solid angle, where rays are parallel) adds to the mean radiance of the film.
    pub importance: f32,
}

impl Sensor {
    /// How the world point `point` shows on the film, through a point of the aperture; `aperture` is
    /// uniform in [0, 1)². `None` where it does not show, or where the sensor is not one that a
    /// particle can meet.
    #[must_use]
    pub fn connect(&self, point: Vec3, aperture: Vec2) -> Option<Connection> {
        let connection = match self {
            Self::Orthographic(sensor) => sensor.connect(point),
            Self::Perspective(sensor) => sensor.connect(point),
            Self::ThinLens(sensor) => sensor.connect(point, aperture),
            _ => None,
        }?;
        let is_finite = connection.importance.is_finite() && connection.film_position.is_finite();
        is_finite.then_some(connection)
    }
}

/// The reverse of a pinhole: `path` leads from the lens to the point in camera space, `focus` to where
/// the film shows it at distance one.
///
/// The film's unit square is A = 4·halfwidth·halfheight at distance one. A part of it that takes the
/// solid angle dω at an angle θ from the view is dω / (A cos³θ): that is what radiance counts, and a
/// power I per solid angle at a distance r makes a radiance of I/r² over it.
pub(super) fn pinhole(view: &View, path: Vec3, focus: Vec2) -> Option<(Vec2, f32)> {
    let half_size = view.half_size.as_vec2();
    let place = (Vec2::ONE - focus / half_size) * 0.5 - view.shift.as_vec2();
    let cosine = path.z / path.length();
    let area = 4.0 * half_size.x * half_size.y;
    (path.z > 0.0).then(|| (place, 1.0 / (area * cosine.powi(3))))
}
