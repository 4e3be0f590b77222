//! Light that a path hits without next-event estimation: emitting surfaces and environments.

use super::mis::power_heuristic;
use etendue_scene::{EmitterId, Scene, SurfaceInteraction};
use etendue_spectrum::Spectrum;
use glam::Vec3;

/// Light that a path has hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emission<'a> {
    /// The emitter.
    emitter: EmitterId,
    /// The radiance; not black.
    pub(crate) radiance: Spectrum,
    /// The hit on the emitter's shape; `None` for distant light.
    surface: Option<&'a SurfaceInteraction>,
}

impl<'a> Emission<'a> {
    /// Light that a surface emits back along the ray that hit it.
    #[inline(always)]
    pub(crate) fn of_surface(scene: &Scene, surface: &'a SurfaceInteraction) -> Option<Self> {
        let emitter = scene.emitter_of(surface)?;
        let radiance = scene.emitter(emitter).surface_radiance(scene, surface);
        (!radiance.is_black()).then_some(Self { emitter, radiance, surface: Some(surface) })
    }

    /// Distant light along a ray that leaves the scene.
    #[inline]
    pub(crate) fn from_afar(scene: &Scene, direction: Vec3) -> impl Iterator<Item = Self> {
        scene.environments().iter().filter_map(move |&emitter| {
            let radiance = scene.emitter(emitter).distant_radiance(direction);
            (!radiance.is_black()).then_some(Self { emitter, radiance, surface: None })
        })
    }

    /// The density with which next-event estimation at `point` would have sampled this light, which
    /// lies in `direction`.
    #[inline]
    pub(crate) fn next_event_pdf(&self, scene: &Scene, point: Vec3, direction: Vec3) -> f32 {
        let emitter = scene.emitter(self.emitter);
        let pdf = emitter.pdf_direction(scene, point, direction, self.surface);
        pdf * scene.emitter_probability(self.emitter)
    }
}

/// The previous vertex of a path, for light found in the sampled direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathVertex {
    /// The position.
    pub(crate) point: Vec3,
    /// The solid angle density of the sampled direction if next-event estimation at the vertex
    /// competes with it; `None` if only this technique can find the light.
    pub(crate) pdf: Option<f32>,
}

impl PathVertex {
    /// The camera.
    #[inline]
    pub(crate) fn camera(point: Vec3) -> Self {
        Self { point, pdf: None }
    }

    /// The weighted radiance found in `direction`.
    #[inline(always)]
    fn weigh(&self, scene: &Scene, emission: &Emission<'_>, direction: Vec3) -> Spectrum {
        let weight = self.pdf.map_or(1.0, |pdf| {
            power_heuristic(pdf, emission.next_event_pdf(scene, self.point, direction))
        });
        emission.radiance * weight
    }
}

/// The weighted radiance that a surface emits back along the ray that hit it.
#[inline(always)]
pub(crate) fn emitted(
    scene: &Scene,
    surface: &SurfaceInteraction,
    direction: Vec3,
    vertex: &PathVertex,
) -> Spectrum {
    Emission::of_surface(scene, surface)
        .map_or(Spectrum::ZERO, |emission| vertex.weigh(scene, &emission, direction))
}

/// The weighted distant radiance along a ray that leaves the scene.
#[inline]
pub(crate) fn distant(scene: &Scene, direction: Vec3, vertex: &PathVertex) -> Spectrum {
    Emission::from_afar(scene, direction)
        .fold(Spectrum::ZERO, |sum, emission| sum + vertex.weigh(scene, &emission, direction))
}
