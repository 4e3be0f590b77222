//! Phase functions: how media scatter light.
//!
//! # Contract
//! - `wi` and `wo` are unit, in world space, and point away from the place of scattering; `wi` is
//!   where the path comes from. Light that goes straight on has `wo` = −`wi`.
//! - The value of a phase function is its density in solid angle: it integrates to one, and sampling
//!   follows it exactly, so that samples carry no weight.
//! - [`PhaseFunction::sample`] uses one number to choose among parts and two for the direction.

pub mod blendphase;
pub mod hg;
pub mod isotropic;
pub mod rayleigh;
pub mod sggx;
pub mod tabphase;
#[cfg(test)]
mod tests;

use crate::volume::gridvolume::GridVolume;
use etendue_math::Frame;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;
use std::sync::Arc;

/// A phase function of the scene.
#[derive(Clone, Debug)]
pub enum PhaseFunction {
    /// The same in all directions.
    Isotropic,
    /// Henyey and Greenstein's.
    HenyeyGreenstein(hg::HenyeyGreenstein),
    /// Rayleigh's, of particles much smaller than the wavelength.
    Rayleigh,
    /// A mixture of two others.
    Blend(Box<blendphase::Blend>),
    /// A table over the cosine of the scattering angle.
    Tabulated(Box<tabphase::Tabulated>),
    /// Microflakes.
    Sggx(sggx::Sggx),
}

/// Where light is scattered.
#[derive(Clone, Copy, Debug)]
pub struct MediumInteraction {
    /// The place.
    pub point: Vec3,
    /// Where the path comes from.
    pub wi: Vec3,
}

/// A direction that a phase function chose.
#[derive(Clone, Copy, Debug)]
pub struct PhaseSample {
    /// Where the path goes on.
    pub wo: Vec3,
    /// The density in solid angle, which is the value as well.
    pub pdf: f32,
}

impl PhaseFunction {
    /// The density of `wo`; see the module's contract.
    #[inline]
    #[must_use]
    pub fn eval(&self, site: &MediumInteraction, wo: Vec3) -> f32 {
        match self {
            Self::Isotropic => isotropic::DENSITY,
            Self::HenyeyGreenstein(phase) => phase.eval(forwardness(site, wo)),
            Self::Rayleigh => rayleigh::eval(forwardness(site, wo)),
            Self::Blend(phase) => phase.eval(site, wo),
            Self::Tabulated(phase) => phase.eval(forwardness(site, wo)),
            Self::Sggx(phase) => phase.eval(site, wo),
        }
    }

    /// Chooses `wo`; `None` where it fails. `part` and `direction` are uniform in [0, 1).
    #[inline]
    #[must_use]
    pub fn sample(
        &self,
        site: &MediumInteraction,
        part: f32,
        direction: Vec2,
    ) -> Option<PhaseSample> {
        match self {
            Self::Isotropic => Some(isotropic::sample(direction)),
            Self::HenyeyGreenstein(phase) => Some(phase.sample(site, direction)),
            Self::Rayleigh => Some(rayleigh::sample(site, direction)),
            Self::Blend(phase) => phase.sample(site, part, direction),
            Self::Tabulated(phase) => Some(phase.sample(site, direction)),
            Self::Sggx(phase) => phase.sample(site, direction),
        }
    }

    /// What the extinction along a direction is multiplied by: the area of microflakes seen from it,
    /// and 1 for all others.
    #[inline]
    #[must_use]
    pub fn projected_area(&self, site: &MediumInteraction) -> f32 {
        match self {
            Self::Sggx(phase) => phase.projected_area(site),
            Self::Blend(phase) => phase.projected_area(site),
            _ => 1.0,
        }
    }

    /// The greatest value that [`Self::projected_area`] takes anywhere.
    #[must_use]
    pub fn greatest_area(&self) -> f32 {
        match self {
            Self::Sggx(phase) => phase.greatest_area(),
            Self::Blend(phase) => phase.greatest_area(),
            _ => 1.0,
        }
    }

    /// Whether the projected area is one everywhere: there are no microflakes.
    fn shows_one_area(&self) -> bool {
        match self {
            Self::Sggx(_) => false,
            Self::Blend(phase) => phase.parts().iter().all(Self::shows_one_area),
            _ => true,
        }
    }

    /// Adds the grids that the phase function reads.
    pub(crate) fn collect_grids<'a>(&'a self, grids: &mut Vec<&'a Arc<GridVolume>>) {
        match self {
            Self::Sggx(phase) => grids.extend(phase.grid()),
            Self::Blend(phase) => {
                grids.extend(phase.weight().grid());
                phase.parts().iter().for_each(|part| part.collect_grids(grids));
            }
            _ => {}
        }
    }

    /// Whether the projected area is the same everywhere for a direction.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        match self {
            Self::Sggx(phase) => phase.is_uniform(),
            Self::Blend(phase) => phase.has_uniform_area(),
            _ => true,
        }
    }
}

/// The cosine of the scattering angle: 1 where light goes straight on.
#[inline]
fn forwardness(site: &MediumInteraction, wo: Vec3) -> f32 {
    -site.wi.dot(wo)
}

/// The direction that turns light at `site` by an angle of the cosine `forwardness`, at an azimuth of
/// `turn` (in whole turns).
#[inline]
fn deflected(site: &MediumInteraction, forwardness: f32, turn: f32) -> Vec3 {
    let sine = (1.0 - forwardness * forwardness).max(0.0).sqrt();
    let (y, x) = (TAU * turn).sin_cos();
    Frame::from_normal(-site.wi).to_world(Vec3::new(sine * x, sine * y, forwardness))
}
