//! From a point of the scene to the film, for tracing particles.

use super::image_plane::View;
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

/// The reverse of a pinhole: `path` leads from the lens to the point in camera space, `focus` to where
/// the film shows it at distance one.
///
/// The film's unit square is A = 4·halfwidth·halfheight at distance one. A part of it that takes the
/// solid angle dω at an angle θ from the view is dω / (A cos³θ): that is what radiance counts, and a
/// power I per solid angle at a distance r makes a radiance of I/r² over it.
pub(crate) fn pinhole(view: &View, path: Vec3, focus: Vec2) -> Option<(Vec2, f32)> {
    let half_size = view.half_size.as_vec2();
    let place = (Vec2::ONE - focus / half_size) * 0.5 - view.shift.as_vec2();
    let cosine = path.z / path.length();
    let area = 4.0 * half_size.x * half_size.y;
    (path.z > 0.0).then(|| (place, 1.0 / (area * cosine.powi(3))))
}
