//! Next-event estimation: direct light from an emitter.

use super::mis::next_event_weight;
use super::shading::{Scattering, ShadingPoint, StrictNormals};
use etendue_math::Ray;
use etendue_math::lanes::{Mask as _, Real, Vector3};
use etendue_scene::bsdf::Bsdf;
use etendue_scene::emitter::{DirectionSample, LightLanes};
use etendue_scene::{Scene, SurfaceInteraction};
use etendue_spectrum::{Spectrum, SpectrumLanes};
use glam::Vec2;

/// Light that reaches a surface unless it is occluded: the part of a [`DirectionSample`] or of
/// [`LightLanes`] that the rules need.
#[derive(Clone, Copy)]
pub(crate) struct IncidentLight<R: Real> {
    pub(crate) direction: Vector3<R>,
    pub(crate) radiance: SpectrumLanes<R>,
    pub(crate) pdf: R,
    pub(crate) delta: R::Mask,
    pub(crate) exists: R::Mask,
}

/// The weighted fraction of light that is scattered back along a path.
#[derive(Clone, Copy)]
pub(crate) struct ReflectedLight<R: Real> {
    pub(crate) radiance: SpectrumLanes<R>,
    /// Whether it is nonzero.
    pub(crate) exists: R::Mask,
}

/// A pending contribution: light that is scattered back along a path unless the shadow ray is
/// blocked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProposedLight {
    /// The shadow ray.
    pub(crate) shadow_ray: Ray,
    /// The weighted fraction of light scattered back if the ray is free.
    pub(crate) radiance: Spectrum,
}

/// Next-event estimation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NextEvent {
    pub(crate) strict_normals: StrictNormals,
    /// The number of BSDF samples for each emitter sample.
    pub(crate) scatter_ratio: f32,
}

impl NextEvent {
    /// The fraction of `light` scattered back along the path, weighted against the chance that BSDF
    /// sampling finds it.
    #[inline(always)]
    pub(crate) fn reflect<R: Real>(
        &self,
        point: &ShadingPoint<R>,
        scattering: &impl Scattering<R>,
        light: &IncidentLight<R>,
    ) -> ReflectedLight<R> {
        let wo = point.frame.to_local(light.direction);
        let (value, scatter_pdf) = scattering.eval_pdf(point.wi, wo);
        let contribution = value * light.radiance;
        let exists = self.strict_normals.cut(light.exists, point, light.direction, wo);
        let exists = exists & !contribution.is_black();
        if !exists.any() {
            return ReflectedLight { radiance: contribution, exists };
        }
        let scatter_pdf = scatter_pdf * self.scatter_ratio;
        let weight = next_event_weight(light.pdf, light.delta, scatter_pdf);
        ReflectedLight { radiance: contribution * (weight / light.pdf), exists }
    }

    /// Like [`reflect`](Self::reflect), for a single hit.
    #[inline(always)]
    pub(crate) fn reflect_at_hit(
        &self,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        light: &DirectionSample,
    ) -> Option<ProposedLight> {
        let reflected = self.reflect(&surface.into(), bsdf, &light.into());
        reflected.exists.then(|| ProposedLight {
            shadow_ray: light.shadow_ray(surface),
            radiance: reflected.radiance.into(),
        })
    }

    /// Light from one randomly chosen emitter, scattered at `surface` back along the path.
    pub(crate) fn propose(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        random: Vec2,
    ) -> Option<ProposedLight> {
        if !bsdf.has_smooth_lobe() {
            return None;
        }
        let light = scene.sample_light(surface.point, random)?;
        self.reflect_at_hit(surface, bsdf, &light)
    }
}

impl<R: Real> From<&LightLanes<R>> for IncidentLight<R> {
    #[inline(always)]
    fn from(light: &LightLanes<R>) -> Self {
        let LightLanes { direction, radiance, pdf, delta, exists, .. } = *light;
        Self { direction, radiance, pdf, delta, exists }
    }
}

impl From<&DirectionSample> for IncidentLight<f32> {
    #[inline(always)]
    fn from(light: &DirectionSample) -> Self {
        Self {
            direction: light.direction.into(),
            radiance: light.radiance.into(),
            pdf: light.pdf,
            delta: light.delta,
            exists: true,
        }
    }
}
