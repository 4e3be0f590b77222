//! Alpha: whether a camera sample sees anything.

use super::hide_emitters::HideEmitters;
use etendue_scene::Scene;

/// The alpha of a camera sample. It is 1 once the path ends or is scattered somewhere, or sees an
/// environment that is visible to the camera, and 0 until then. Null transmission does not change
/// it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Alpha(f32);

impl Alpha {
    /// The path ends or is scattered at a surface or in a medium.
    #[inline(always)]
    pub(crate) fn cover(&mut self) {
        self.0 = 1.0;
    }

    /// The path leaves the scene.
    #[inline]
    pub(crate) fn escape(&mut self, scene: &Scene, hide_emitters: HideEmitters) {
        if !hide_emitters.0 && !scene.environments().is_empty() {
            self.cover();
        }
    }

    /// Whether the path still continues the camera ray: it has passed straight through surfaces at
    /// most.
    #[inline(always)]
    pub(crate) fn is_camera_ray(self) -> bool {
        self.0 == 0.0
    }

    /// The alpha value.
    #[inline]
    pub(crate) fn value(self) -> f32 {
        self.0
    }
}
