//! From a point of the scene to the film, for tracing particles.

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
