//! The sky over all directions: the upper half, or stretched below the horizon as in Mitsuba 0.6.

use super::model::Sky;
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Where light seems to come from at the horizon, when the sky goes on below it.
const JUST_ABOVE_HORIZON: f32 = FRAC_PI_2 - 1e-4;

/// The sky in the emitter's space.
#[derive(Clone, Debug)]
pub(super) struct Dome {
    pub(super) sky: Sky,
    /// Unit.
    pub(super) sun_direction: Vec3,
    /// Polar angles are divided by it.
    pub(super) stretch: f32,
    /// Whether the sky fades out below the horizon instead of ending there.
    pub(super) extend: bool,
}

impl Dome {
    /// The polar angle up to which there is light.
    pub(super) fn reach(&self) -> f32 {
        if self.extend { PI } else { (self.stretch * FRAC_PI_2).min(PI) }
    }

    /// Whether there is light from a unit direction.
    pub(super) fn covers(&self, direction: Vec3) -> bool {
        if self.is_upper_half() {
            return direction.z >= 0.0;
        }
        polar_angle(direction) <= self.reach()
    }

    /// The radiance from a unit direction that is covered.
    pub(super) fn radiance(&self, direction: Vec3) -> Spectrum {
        if self.is_upper_half() {
            return self.model_radiance(direction);
        }
        let theta = polar_angle(direction);
        let (sin, cos) = (theta / self.stretch).min(JUST_ABOVE_HORIZON).sin_cos();
        let across = direction.truncate().normalize_or(Vec2::X);
        let radiance = self.model_radiance((sin * across).extend(cos));
        if !self.extend {
            return radiance;
        }
        let above_nadir = (2.0 - theta / FRAC_PI_2).clamp(0.0, 1.0);
        radiance * (above_nadir * above_nadir * (3.0 - 2.0 * above_nadir))
    }

    fn is_upper_half(&self) -> bool {
        self.stretch == 1.0 && !self.extend
    }

    /// The radiance of the model, which is defined above the horizon.
    fn model_radiance(&self, direction: Vec3) -> Spectrum {
        // Accurate at all angles; the arc cosine loses precision at small ones.
        let chord = (direction - self.sun_direction).length();
        let gamma = 2.0 * (0.5 * chord).min(1.0).asin();
        Spectrum::from_rgb(self.sky.radiance(direction.z, gamma).map(|value| value.max(0.0)))
    }

    /// The unit direction of a point in the unit square, which holds azimuth and polar angle.
    pub(super) fn unmap(&self, place: Vec2) -> Vec3 {
        let (sin_azimuth, cos_azimuth) = (place.x * TAU).sin_cos();
        let (sin_theta, cos_theta) = (place.y * self.reach()).sin_cos();
        let cos_theta = if self.is_upper_half() { cos_theta.max(0.0) } else { cos_theta };
        Vec3::new(sin_theta * cos_azimuth, sin_theta * sin_azimuth, cos_theta)
    }

    /// The inverse of [`Self::unmap`].
    pub(super) fn map(&self, direction: Vec3) -> Vec2 {
        let azimuth = direction.y.atan2(direction.x) / TAU;
        let theta = polar_angle(direction) / self.reach();
        Vec2::new(azimuth - azimuth.floor(), theta).min(Vec2::splat(1.0 - f32::EPSILON))
    }
}

/// The angle between a direction and +z.
fn polar_angle(direction: Vec3) -> f32 {
    direction.truncate().length().atan2(direction.z)
}
