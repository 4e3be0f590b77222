//! Closures of several paths at once.
//!
//! The materials that nearly all surfaces have are written over any [`Real`]: [`LaneClosure`] is their
//! mathematics, which a hit alone uses as well. [`ClosureLanes`] holds the closures of up to
//! [`MAX_LANES`](etendue_math::lanes::MAX_LANES) hits whose materials are of one [`LaneKind`].

use crate::bsdf::{BsdfSample, Closure, Lobe, Transport};
use etendue_math::lanes::{Real, Vector2, Vector3};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::{Vec2, Vec3};

/// Directions that closures chose; see [`BsdfSample`]. Lanes that do not exist hold anything.
#[derive(Clone, Copy)]
pub struct SampleLanes<R: Real> {
    /// Where the paths go on, in the local frame.
    pub wo: Vector3<R>,
    /// f(wi, wo)·|cos θo| divided by `pdf`.
    pub weight: SpectrumLanes<R>,
    /// The density in solid angle; where the sample is not smooth, the lobe's probability.
    pub pdf: R,
    /// The index of refraction on the side of `wo` over that on the side of `wi`.
    pub eta: R,
    /// Whether there is a sample at all: where not, it counts as one of weight zero.
    pub exists: R::Mask,
    /// Whether the direction has a density in solid angle; see [`Lobe::is_smooth`].
    pub smooth: R::Mask,
    /// Whether the path goes straight on, as if no surface were there ([`Lobe::Null`]).
    pub straight: R::Mask,
}

impl<R: Real> SampleLanes<R> {
    /// No sample in any lane.
    #[inline(always)]
    #[must_use]
    pub fn none(wi: Vector3<R>) -> Self {
        let (zero, never) = (wi.z.zero(), wi.z.lt(wi.z));
        Self {
            wo: wi,
            weight: SpectrumLanes::grey(zero),
            pdf: zero,
            eta: zero + 1.0,
            exists: never,
            smooth: never,
            straight: never,
        }
    }

    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            wo: Vector3::select(mask, yes.wo, no.wo),
            weight: SpectrumLanes::select(mask, yes.weight, no.weight),
            pdf: R::select(mask, yes.pdf, no.pdf),
            eta: R::select(mask, yes.eta, no.eta),
            exists: mask & yes.exists | !mask & no.exists,
            smooth: mask & yes.smooth | !mask & no.smooth,
            straight: mask & yes.straight | !mask & no.straight,
        }
    }

    /// As [`none`](Self::none), but smooth should it exist.
    #[inline(always)]
    pub(crate) fn smooth(wi: Vector3<R>) -> Self {
        let none = Self::none(wi);
        Self { smooth: !none.smooth, ..none }
    }
}

/// The mathematics of a closure over any [`Real`]; the contract is that of [`Closure`].
pub(crate) trait LaneClosure<R: Real> {
    /// See [`Closure::eval_pdf`].
    fn eval_pdf_lanes(
        &self,
        wi: Vector3<R>,
        wo: Vector3<R>,
        transport: Transport,
    ) -> (SpectrumLanes<R>, R);

    /// See [`Closure::sample`].
    fn sample_lanes(
        &self,
        wi: Vector3<R>,
        lobe: R,
        direction: Vector2<R>,
        transport: Transport,
    ) -> SampleLanes<R>;
}

/// Passes the numbers of a closure on, one after the other.
pub(crate) trait Transfer<R: Real, T: Real> {
    /// What a number becomes.
    fn number(&mut self, number: R) -> T;

    /// What a spectrum becomes.
    #[inline(always)]
    fn spectrum(&mut self, spectrum: SpectrumLanes<R>) -> SpectrumLanes<T> {
        spectrum.convert(
            #[inline(always)]
            |component| self.number(component),
        )
    }
}

/// What a closure of one hit has beside its [`LaneClosure`]; it is then a [`Closure`].
pub(crate) trait HitClosure: LaneClosure<f32> {
    /// See [`Closure::straight`].
    fn null_transmission(&self, _wi: Vec3) -> (Spectrum, f32) {
        (Spectrum::ZERO, 0.0)
    }

    /// See [`Closure::has_smooth_lobe`].
    fn has_smooth_lobe(&self) -> bool;

    /// See [`Closure::albedo`].
    fn albedo(&self, wi: Vec3) -> Spectrum;
}

impl<C: HitClosure> Closure for C {
    #[inline]
    fn eval_pdf(&self, wi: Vec3, wo: Vec3, transport: Transport) -> (Spectrum, f32) {
        let (value, pdf) = self.eval_pdf_lanes(wi.into(), wo.into(), transport);
        (value.into(), pdf)
    }

    #[inline]
    fn sample(
        &self,
        wi: Vec3,
        lobe: f32,
        direction: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let sample = self.sample_lanes(wi.into(), lobe, direction.into(), transport);
        let lobe = match (sample.smooth, sample.straight) {
            (true, _) => Lobe::Smooth,
            (false, true) => Lobe::Null,
            (false, false) => Lobe::Delta,
        };
        sample.exists.then(|| BsdfSample {
            wo: sample.wo.into(),
            weight: sample.weight.into(),
            pdf: sample.pdf,
            eta: sample.eta,
            lobe,
        })
    }

    fn null_transmission(&self, wi: Vec3) -> (Spectrum, f32) {
        HitClosure::null_transmission(self, wi)
    }

    #[inline]
    fn has_smooth_lobe(&self) -> bool {
        HitClosure::has_smooth_lobe(self)
    }

    fn albedo(&self, wi: Vec3) -> Spectrum {
        HitClosure::albedo(self, wi)
    }
}
