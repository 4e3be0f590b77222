//! How a path goes on from a surface.

use super::numbers::ScatterNumbers;
use super::roulette::Roulette;
use super::shading::{Scattering, ShadingPoint, StrictNormals};
use etendue_math::lanes::{Real, Vector3};
use etendue_scene::SurfaceInteraction;
use etendue_scene::bsdf::{Bsdf, SampleLanes};
use etendue_spectrum::SpectrumLanes;

/// What a path carries.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathWeight<R> {
    /// The share of the light at the end of the path that arrives at the camera.
    pub(crate) throughput: SpectrumLanes<R>,
    /// The index of refraction here relative to the camera's; see [`Roulette::play`].
    pub(crate) eta: R,
}

/// How a path goes on from a surface, if it does.
#[derive(Clone, Copy)]
pub(crate) struct Continuation<R: Real> {
    /// Whether it does. Where not, only `null` means anything.
    pub(crate) exists: R::Mask,
    /// Whether it passes straight through, as if no surface were there.
    pub(crate) null: R::Mask,
    /// Whether next-event estimation could have found the direction, too.
    pub(crate) smooth: R::Mask,
    /// The unit direction, in the world.
    pub(crate) direction: Vector3<R>,
    /// The density of the direction in solid angle, where it is smooth.
    pub(crate) pdf: R,
    /// What the path carries from here on.
    pub(crate) weight: PathWeight<R>,
}

impl<R: Real> Continuation<R> {
    /// Chooses a direction for a path that arrives with `weight`. Strict normals let pass what goes
    /// straight through.
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

    /// Ends the path by Russian roulette, or lets it stand for those that end.
    #[inline(always)]
    pub(crate) fn play_roulette(&mut self, random: R) {
        let PathWeight { throughput, eta } = self.weight;
        let Roulette { survives, gain } = Roulette::play(throughput.max_component(), eta, random);
        self.exists = self.exists & survives;
        self.weight.throughput = throughput * gain;
    }
}

impl Continuation<f32> {
    /// As [`sample`](Self::sample), for a single hit.
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
