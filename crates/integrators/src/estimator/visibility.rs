//! Finds the first hit of a ray, ignoring surfaces that do not count.

use super::alpha::Alpha;
use super::emission::{PathVertex, distant};
use super::hide_emitters::HideEmitters;
use crate::integrator::Radiance;
use etendue_math::Ray;
use etendue_scene::{Hit, Scene, SurfaceInteraction};

/// The first hit of a camera ray. Hidden emitters are skipped, and distances then count from the
/// last of them.
#[inline]
pub(crate) fn first_hit(
    scene: &Scene,
    ray: &Ray,
    hide_emitters: HideEmitters,
) -> Option<SurfaceInteraction> {
    let mut ray = *ray;
    let mut hit = scene.closest_hit(&ray);
    if hide_emitters.0 {
        skip_hits(scene, &mut ray, &mut hit, &mut |surface| hide_emitters.hides(scene, surface));
    }
    hit.map(|hit| scene.interaction(&ray, &hit))
}

/// The first hit of a camera ray, skipping hidden emitters, or else the background it sees.
#[inline]
pub(crate) fn first_surface(
    scene: &Scene,
    ray: &Ray,
    hide_emitters: HideEmitters,
) -> Result<SurfaceInteraction, Radiance> {
    first_hit(scene, ray, hide_emitters).ok_or_else(|| {
        let mut background = Radiance::NONE;
        if !hide_emitters.0 {
            background.color = distant(scene, ray.direction, &PathVertex::camera(ray.origin));
        }
        let mut alpha = Alpha::default();
        alpha.escape(scene, hide_emitters);
        Radiance { alpha: alpha.value(), ..background }
    })
}

/// Moves on through ignored surfaces to the next hit that counts. The ray then starts at the last
/// of them; its end does not change.
#[cold]
pub(crate) fn skip_hits(
    scene: &Scene,
    ray: &mut Ray,
    hit: &mut Option<Hit>,
    skips: &mut dyn FnMut(&SurfaceInteraction) -> bool,
) {
    while let Some(found) = hit {
        let surface = scene.interaction(ray, found);
        if !skips(&surface) {
            return;
        }
        *ray = Ray { t_max: ray.t_max - surface.t, ..surface.spawn_ray(ray.direction) };
        *hit = scene.closest_hit(ray);
    }
}
