//! What path and direct lighting share: next-event estimation, emission found by chance, and how
//! the two are weighed against each other.

use crate::Radiance;
use etendue_math::Ray;
use etendue_math::lanes::Real;
use etendue_scene::bsdf::{Bsdf, Transport};
use etendue_scene::emitter::DirectionSample;
use etendue_scene::{Hit, Scene, SurfaceInteraction};
use etendue_spectrum::Spectrum;
use glam::{Vec2, Vec3};

/// The weight of a sample of density `pdf` when another technique could have found it with density
/// `other` (Veach, *Robust Monte Carlo Methods for Light Transport Simulation*, 1997, section 9.2.4:
/// the power heuristic with exponent two).
#[inline(always)]
#[must_use]
pub(crate) fn power_heuristic<R: Real>(pdf: R, other: R) -> R {
    let squared = pdf * pdf;
    let sum = squared + other * other;
    // Squares overflow beyond 1e19, where the larger density alone decides.
    let greater = R::select(pdf.gt(other), pdf.like(1.0), pdf.zero());
    R::select(sum.is_finite(), squared / sum, greater)
}

/// A vertex that chose a direction: what the emission found there is weighed against.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Origin {
    /// The vertex.
    pub(crate) point: Vec3,
    /// The density in solid angle of the direction taken, where next-event estimation at the vertex
    /// competes with it; `None` where only this technique can find light.
    pub(crate) pdf: Option<f32>,
}

impl Origin {
    /// The weight of emission found in `direction`.
    #[inline]
    fn weight(
        &self,
        scene: &Scene,
        emitter: etendue_scene::EmitterId,
        direction: Vec3,
        surface: Option<&SurfaceInteraction>,
    ) -> f32 {
        let Some(pdf) = self.pdf else { return 1.0 };
        let by_emitter =
            scene.emitter(emitter).pdf_direction(scene, self.point, direction, surface);
        power_heuristic(pdf, by_emitter * scene.emitter_probability(emitter))
    }
}

/// Radiance that the surface itself sends back along the ray that found it, weighed.
#[inline(always)]
pub(crate) fn emitted(
    scene: &Scene,
    surface: &SurfaceInteraction,
    direction: Vec3,
    origin: &Origin,
) -> Spectrum {
    let Some(emitter) = scene.emitter_of(surface) else { return Spectrum::ZERO };
    let radiance = scene.emitter(emitter).surface_radiance(scene, surface);
    if radiance.is_black() {
        return Spectrum::ZERO;
    }
    radiance * origin.weight(scene, emitter, direction, Some(surface))
}

/// Radiance from afar along a ray that leaves the scene, weighed.
#[inline]
pub(crate) fn distant(scene: &Scene, direction: Vec3, origin: &Origin) -> Spectrum {
    scene.environments().iter().fold(Spectrum::ZERO, |sum, &emitter| {
        let radiance = scene.emitter(emitter).distant_radiance(direction);
        sum + radiance * origin.weight(scene, emitter, direction, None)
    })
}

/// Light that arrives unless something stands between.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProposedLight {
    /// The ray that must be free.
    pub(crate) shadow_ray: Ray,
    /// What then goes back along the path, weighed.
    pub(crate) radiance: Spectrum,
}

/// Next-event estimation: light straight from an emitter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NextEvent {
    /// Whether light must be on the same side of the geometric as of the shading normal.
    pub(crate) strict_normals: bool,
    /// How many directions the material samples for each one that the emitters sample.
    pub(crate) scatter_ratio: f32,
}

impl NextEvent {
    /// Light that one emitter, chosen by chance, sends over `surface` back along the path, weighed
    /// against the chance that scattering finds it.
    #[inline(always)]
    pub(crate) fn estimate(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        random: Vec2,
    ) -> Spectrum {
        let proposed = scene
            .sample_light(surface.point, random)
            .and_then(|light| self.reflect(surface, bsdf, &light));
        match proposed {
            Some(light) if !scene.occluded(&light.shadow_ray) => light.radiance,
            _ => Spectrum::ZERO,
        }
    }

    /// The share of `light` that goes back along the path, if nothing stands between.
    #[inline(always)]
    pub(crate) fn reflect(
        &self,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        light: &DirectionSample,
    ) -> Option<ProposedLight> {
        let wo = surface.to_local(light.direction);
        if self.strict_normals && light.direction.dot(surface.normal) * wo.z <= 0.0 {
            return None;
        }
        let (value, scatter_pdf) = bsdf.eval_pdf(surface.wi, wo, Transport::Radiance);
        let contribution = value * light.radiance;
        if contribution.is_black() {
            return None;
        }
        let other = scatter_pdf * self.scatter_ratio;
        let weight = if light.delta { 1.0 } else { power_heuristic(light.pdf, other) };
        Some(ProposedLight {
            shadow_ray: light.shadow_ray(surface),
            radiance: contribution * (weight / light.pdf),
        })
    }
}

/// What a camera ray hits first, emitters left out if they are to be hidden: distances then count from
/// the last of them.
#[inline]
pub(crate) fn first_hit(
    scene: &Scene,
    ray: &Ray,
    hide_emitters: bool,
) -> Option<SurfaceInteraction> {
    let mut ray = *ray;
    let mut hit = scene.closest_hit(&ray)?;
    if hide_emitters {
        hit = beyond_emitters(scene, &mut ray, hit)?;
    }
    Some(scene.interaction(&ray, &hit))
}

/// Goes on through emitters that are hidden from the camera. The ray then starts at the last of them,
/// and ends where it did.
#[cold]
pub(crate) fn beyond_emitters(scene: &Scene, ray: &mut Ray, mut hit: Hit) -> Option<Hit> {
    loop {
        let surface = scene.interaction(ray, &hit);
        if scene.emitter_of(&surface).is_none() {
            return Some(hit);
        }
        *ray = Ray { t_max: ray.t_max - surface.t, ..surface.spawn_ray(ray.direction) };
        hit = scene.closest_hit(ray)?;
    }
}

/// What a camera ray hits first, emitters left out if they are to be hidden, or else what it sees of
/// the background.
#[inline]
pub(crate) fn first_sight(
    scene: &Scene,
    ray: &Ray,
    hide_emitters: bool,
) -> Result<SurfaceInteraction, Radiance> {
    first_hit(scene, ray, hide_emitters).ok_or_else(|| {
        if hide_emitters || scene.environments().is_empty() {
            return Radiance::NONE;
        }
        let seen = Origin { point: ray.origin, pdf: None };
        Radiance { color: distant(scene, ray.direction, &seen), alpha: 1.0 }
    })
}
