//! Connections from scene points to the film, for particle tracing.

use glam::{Vec2, Vec3};

/// How a scene point projects onto the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection {
    /// The position on the whole film, which is [0, 1)²; it may lie outside.
    pub film_position: Vec2,
    /// The unit world direction from the point to the sensor.
    pub direction: Vec3,
    /// The visible distance from the sensor's near plane to the point, in world units.
    pub distance: f32,
    /// What one unit of power per solid angle that leaves the point towards the sensor adds to the
    /// mean radiance of the film. For parallel rays, the unit is power per area and solid angle.
    pub importance: f32,
}
