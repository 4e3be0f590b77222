//! Materials, and the closures that they become at a hit.
//!
//! A [`Material`] is what the scene file describes, with its textures. At a hit,
//! [`Materials::prepare`] reads every texture once and gives a [`Bsdf`]: pure mathematics in the
//! local frame, shared by next-event estimation and path sampling.
//!
//! # Contract of every [`Closure`]
//! - `wi` and `wo` are unit, in the local shading frame (z is the normal), and both point away from
//!   the surface. `wi` is where the path comes from, `wo` where it goes on.
//! - [`Closure::eval_pdf`] gives f(wi, wo)·|cos θo| and the density of `wo` in solid angle.
//!   Delta lobes contribute zero to both.
//! - [`Closure::sample`] gives `wo` with the weight f·|cos θo| / pdf, or `None` where it fails: a
//!   failed sample counts as one of weight zero. It uses one number to choose among lobes and two
//!   for the direction. For a delta lobe, `pdf` is the probability of having chosen that lobe.
//! - Where light is refracted from an index ηi to ηt, radiance is scaled by (ηi/ηt)², seen along
//!   `wi`→`wo`; importance is not. [`Transport`] says which of the two is carried.

pub mod blendbsdf;
pub mod bumpmap;
pub mod circular;
pub mod conductor;
pub mod dielectric;
pub mod diffuse;
pub mod hair;
pub mod mask;
pub mod measured;
pub mod normalmap;
pub mod null;
pub mod plastic;
pub mod polarizer;
pub mod principled;
pub mod principledthin;
pub mod retarder;
pub mod roughconductor;
pub mod roughdielectric;
pub mod roughdiffuse;
pub mod roughplastic;
pub mod thindielectric;
pub mod twosided;

mod prepared;
#[cfg(test)]
mod tests;

pub use crate::batch::{ClosureLanes, LaneKind, LaneMaterial};
pub use crate::lanes::SampleLanes;
pub use prepared::{Bsdf, Gather, Material, Materials, Placement};

use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// What is carried along the path from `wi` to `wo`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Radiance: the path started at the sensor.
    Radiance,
    /// Importance: the path started at an emitter.
    Importance,
}

/// How a sampled direction came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// Spread over many directions.
    Smooth,
    /// One direction only: mirrors and smooth glass.
    Delta,
    /// Straight on, as if no surface were there.
    Null,
}

impl Lobe {
    /// Whether the direction has a density in solid angle, so that other techniques can find it too.
    #[inline]
    #[must_use]
    pub fn is_smooth(self) -> bool {
        self == Self::Smooth
    }
}

/// A direction that a closure chose.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Where the path goes on, in the local frame.
    pub wo: Vec3,
    /// f(wi, wo)·|cos θo| divided by `pdf`.
    pub weight: Spectrum,
    /// The density in solid angle; for [`Lobe::Delta`] and [`Lobe::Null`] the lobe's probability.
    pub pdf: f32,
    /// The index of refraction on the side of `wo` over that on the side of `wi`; 1 unless refracted.
    pub eta: f32,
    /// How the direction came about.
    pub lobe: Lobe,
}

/// A resolved scattering function: numbers only, no textures.
pub trait Closure {
    /// f(wi, wo)·|cos θo| and the density of `wo` given `wi`; see the module's contract.
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32);

    /// Chooses `wo` given `wi`; see the module's contract. `lobe` and `direction` are uniform in [0, 1).
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample>;

    /// The share of light that goes straight on, as if no surface were there ([`Lobe::Null`]), and
    /// the probability with which [`Self::sample`] lets it.
    fn null_transmission(&self, _wi: Vec3) -> (Spectrum, f32) {
        (Spectrum::ZERO, 0.0)
    }

    /// Whether any lobe is smooth, so that next-event estimation can find light.
    fn has_smooth_lobe(&self) -> bool;

    /// The share of light that is scattered in all, roughly: for the albedo layer and for choosing lobes.
    fn albedo(&self, wi: Vec3) -> Spectrum;
}
