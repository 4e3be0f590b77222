//! What every scattering function is asked for, and what it answers.

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
    /// f(wi, wo)·|cos θo| and the density of `wo` given `wi`; see the contract of [`bsdf`](crate::bsdf).
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32);

    /// Chooses `wo` given `wi`; see the contract of [`bsdf`](crate::bsdf). `lobe` and `direction` are uniform in [0, 1).
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
