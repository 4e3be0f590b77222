//! The interface of scattering functions.

use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The quantity carried along the path from `wi` to `wo`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Radiance: the path started at the sensor.
    Radiance,
    /// Importance: the path started at an emitter.
    Importance,
}

/// The kind of lobe that a direction was sampled from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// Spread over many directions.
    Smooth,
    /// A single direction: mirrors and smooth glass.
    Delta,
    /// Straight through, as if there were no surface.
    Null,
}

impl Lobe {
    /// Whether the direction has a density in solid angle, so that other techniques can sample it
    /// too.
    #[inline]
    #[must_use]
    pub fn is_smooth(self) -> bool {
        self == Self::Smooth
    }
}

/// A direction sampled by a closure.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Where the path continues, in the local frame.
    pub wo: Vec3,
    /// f(wi, wo)·|cos θo| divided by `pdf`.
    pub weight: Spectrum,
    /// The density in solid angle; for [`Lobe::Delta`] and [`Lobe::Null`], the probability of the
    /// lobe.
    pub pdf: f32,
    /// The index of refraction on the side of `wo` over that on the side of `wi`; 1 unless refracted.
    pub eta: f32,
    /// The kind of lobe that the direction was sampled from.
    pub lobe: Lobe,
}

/// A resolved scattering function: only numbers, no textures.
pub trait Closure {
    /// f(wi, wo)·|cos θo| and the density of `wo` given `wi`; see the contract of [`bsdf`](crate::bsdf).
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32);

    /// Samples `wo` given `wi`; see the contract of [`bsdf`](crate::bsdf). `lobe` and `direction`
    /// are uniform in [0, 1).
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample>;

    /// The fraction of light that passes straight through as if there were no surface
    /// ([`Lobe::Null`]), and the probability that [`Self::sample`] selects this.
    fn null_transmission(&self, _wi: Vec3) -> (Spectrum, f32) {
        (Spectrum::ZERO, 0.0)
    }

    /// Whether any lobe is smooth, so that next-event estimation can find light.
    fn has_smooth_lobe(&self) -> bool;

    /// The approximate total fraction of light that is scattered, for the albedo layer and for
    /// selecting lobes.
    fn albedo(&self, wi: Vec3) -> Spectrum;
}
