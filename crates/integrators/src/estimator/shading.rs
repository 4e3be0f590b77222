//! The surface data and the scattering functions that the rules use.

use super::numbers::ScatterNumbers;
use etendue_math::lanes::{Frame3, Lanes, Real, Simd, Vector3};
use etendue_scene::bsdf::{Bsdf, BsdfSample, Lobe, SampleLanes, Transport};
use etendue_scene::{ClosureBatch, SurfaceInteraction, SurfaceLanes};
use etendue_spectrum::SpectrumLanes;

/// The surface data that the rules use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadingPoint<R> {
    /// The unit geometric normal.
    pub(crate) normal: Vector3<R>,
    /// The shading frame.
    pub(crate) frame: Frame3<R>,
    /// The unit direction towards the previous vertex, in the shading frame.
    pub(crate) wi: Vector3<R>,
}

/// `strict_normals`: paths and light end where they are on different sides of the geometric and the
/// shading normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrictNormals(pub(crate) bool);

impl StrictNormals {
    /// The `candidates` that may continue in `direction`, which is `local` in the shading frame.
    #[inline(always)]
    pub(crate) fn cut<R: Real>(
        self,
        candidates: R::Mask,
        point: &ShadingPoint<R>,
        direction: Vector3<R>,
        local: Vector3<R>,
    ) -> R::Mask {
        if self.0 {
            candidates & (direction.dot(point.normal) * local.z).above(0.0)
        } else {
            candidates
        }
    }

    /// The `candidates` that may arrive along a ray of this direction.
    #[inline(always)]
    pub(crate) fn cut_arrivals<R: Real>(
        self,
        candidates: R::Mask,
        point: &ShadingPoint<R>,
        ray_direction: Vector3<R>,
    ) -> R::Mask {
        self.cut(candidates, point, -ray_direction, point.wi)
    }
}

impl From<&SurfaceInteraction> for ShadingPoint<f32> {
    #[inline(always)]
    fn from(surface: &SurfaceInteraction) -> Self {
        let frame = &surface.shading;
        Self {
            normal: surface.normal.into(),
            frame: Frame3 { s: frame.s.into(), t: frame.t.into(), n: frame.n.into() },
            wi: surface.wi.into(),
        }
    }
}

impl<R: Real> From<&SurfaceLanes<R>> for ShadingPoint<R> {
    #[inline(always)]
    fn from(surface: &SurfaceLanes<R>) -> Self {
        Self { normal: surface.normal, frame: surface.shading, wi: surface.wi }
    }
}

/// How surfaces scatter radiance: a [`Bsdf`] at one hit, or [`LaneScattering`] at one hit per lane.
/// The contract is that of [`etendue_scene::bsdf`].
pub(crate) trait Scattering<R: Real> {
    /// f(wi, wo)·|cos θo| and the solid angle density of `wo`.
    fn eval_pdf(&self, wi: Vector3<R>, wo: Vector3<R>) -> (SpectrumLanes<R>, R);

    /// Samples `wo` given `wi`.
    fn sample(&self, wi: Vector3<R>, numbers: &ScatterNumbers<R>) -> SampleLanes<R>;
}

impl Scattering<f32> for Bsdf<'_> {
    #[inline(always)]
    fn eval_pdf(&self, wi: Vector3<f32>, wo: Vector3<f32>) -> (SpectrumLanes<f32>, f32) {
        let (value, pdf) = self.eval_pdf(wi.into(), wo.into(), Transport::Radiance);
        (value.into(), pdf)
    }

    #[inline(always)]
    fn sample(&self, wi: Vector3<f32>, numbers: &ScatterNumbers<f32>) -> SampleLanes<f32> {
        let direction = numbers.direction.into();
        let sample = self.sample(wi.into(), numbers.lobe, direction, Transport::Radiance);
        let Some(BsdfSample { wo, weight, pdf, eta, lobe }) = sample else {
            return SampleLanes::none(wi);
        };
        SampleLanes {
            wo: wo.into(),
            weight: weight.into(),
            pdf,
            eta,
            exists: true,
            smooth: lobe.is_smooth(),
            null: lobe == Lobe::Null,
        }
    }
}

/// The closures of the lanes starting at `first`.
#[derive(Clone, Copy)]
pub(crate) struct LaneScattering<'a, S> {
    pub(crate) closures: &'a ClosureBatch<'a>,
    pub(crate) simd: S,
    pub(crate) first: usize,
}

impl<S: Simd> Scattering<Lanes<S>> for LaneScattering<'_, S> {
    #[inline(always)]
    fn eval_pdf(
        &self,
        wi: Vector3<Lanes<S>>,
        wo: Vector3<Lanes<S>>,
    ) -> (SpectrumLanes<Lanes<S>>, Lanes<S>) {
        self.closures.eval_pdf(self.simd, self.first, wi, wo)
    }

    #[inline(always)]
    fn sample(
        &self,
        wi: Vector3<Lanes<S>>,
        numbers: &ScatterNumbers<Lanes<S>>,
    ) -> SampleLanes<Lanes<S>> {
        self.closures.sample(self.simd, self.first, wi, numbers.lobe, numbers.direction)
    }
}
