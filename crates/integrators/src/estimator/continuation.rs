//! How a path continues from a surface.

use super::numbers::ScatterNumbers;
use super::roulette::Roulette;
use super::shading::{Scattering, ShadingPoint, StrictNormals};
use etendue_math::lanes::{Real, Vector3};
use etendue_scene::SurfaceInteraction;
use etendue_scene::bsdf::{Bsdf, SampleLanes};
use etendue_spectrum::SpectrumLanes;

/// The weight of a path and its index of refraction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathWeight<R> {
    /// The throughput: the fraction of light at the end of the path that reaches the camera.
    pub(crate) throughput: SpectrumLanes<R>,
    /// The index of refraction here relative to the camera's; see [`Roulette::play`].
    pub(crate) eta: R,
}

/// How a path continues from a surface, if it does.
#[derive(Clone, Copy)]
pub(crate) struct Continuation<R: Real> {
    /// Whether the path continues. If not, only `null` is meaningful.
    pub(crate) exists: R::Mask,
    /// Whether it is transmitted unchanged, as if no surface were there.
    pub(crate) null: R::Mask,
    /// Whether next-event estimation could also have found the direction.
    pub(crate) smooth: R::Mask,
    /// The unit direction in world space.
    pub(crate) direction: Vector3<R>,
    /// The solid angle density of the direction, if it is not a delta.
    pub(crate) pdf: R,
    /// The weight of the path from here on.
    pub(crate) weight: PathWeight<R>,
}

impl<R: Real> Continuation<R> {
    /// Samples a direction for a path that arrives with `weight`. Strict normals do not affect null
    /// transmission.
    #[inline(always)]
    pub(crate) fn sample(
        point: &ShadingPoint<R>,
        scattering: &impl Scattering<R>,
        weight: PathWeight<R>,
        numbers: &ScatterNumbers<R>,
        strict_normals: StrictNormals,
    ) -> Self {
        let sample = scattering.sample(point.wi, numbers);
        let SampleLanes { wo, weight: sample_weight, pdf, eta, exists, smooth, null } = sample;
        let direction = point.frame.to_world(wo);
        let throughput = weight.throughput * sample_weight;
        let null = null & exists;
        let allowed = null | strict_normals.cut(exists, point, direction, wo);
        Self {
            exists: allowed & !throughput.is_black(),
            null,
            smooth,
            direction,
            pdf,
            weight: PathWeight { throughput, eta: weight.eta * eta },
        }
    }

    /// Plays Russian roulette: ends the path or increases its weight.
    #[inline(always)]
    pub(crate) fn play_roulette(&mut self, random: R) {
        let PathWeight { throughput, eta } = self.weight;
        let Roulette { survives, gain } = Roulette::play(throughput.max_component(), eta, random);
        self.exists = self.exists & survives;
        self.weight.throughput = throughput * gain;
    }
}

impl Continuation<f32> {
    /// Like [`sample`](Self::sample), for a single hit.
    #[inline]
    pub(crate) fn at_hit(
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        weight: PathWeight<f32>,
        numbers: &ScatterNumbers<f32>,
        strict_normals: StrictNormals,
    ) -> Self {
        Self::sample(&surface.into(), bsdf, weight, numbers, strict_normals)
    }
}
