//! `depth`: the distance to the first visible surface.

use crate::integrator::{Integrator, Radiance, Start};
use crate::watch::Watch;
use etendue_sampling::Sampler;
use etendue_scene::{Manual, Scene};
use etendue_spectrum::Spectrum;

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "The distance from the start of the camera ray to what it meets first, in scene units; zero \
              where it meets nothing.",
    parameters: &[],
    sample: r#"<integrator type="depth"/>"#,
};

/// Renders distances.
#[derive(Clone, Copy, Debug, Default)]
pub struct Depth;

impl Integrator for Depth {
    fn needs_light(&self) -> bool {
        false
    }

    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        _: &mut Sampler,
        _: &mut [f32],
        _: &Watch<'_>,
    ) -> Radiance {
        scene.intersect(&start.ray).map_or(Radiance::NONE, |surface| Radiance {
            color: Spectrum::splat(surface.t),
            alpha: 1.0,
        })
    }
}
