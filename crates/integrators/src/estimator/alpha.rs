//! Alpha: whether a camera sample sees anything.

use super::hide_emitters::HideEmitters;
use etendue_scene::Scene;

/// The alpha of a camera sample. It is 1 once the path has met something that it does not pass
/// straight through, or an environment that the camera is to see, and 0 until then.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Alpha(f32);

impl Alpha {
    /// The path ends at or is scattered by a surface or a medium.
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

    /// The alpha itself.
    #[inline]
    pub(crate) fn value(self) -> f32 {
        self.0
    }
}
