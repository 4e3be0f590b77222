//! `hide_emitters`: the camera does not see emitters.

use etendue_scene::{Scene, SurfaceInteraction};

/// Whether rays pass through emitters: with `hide_emitters`, camera rays do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HideEmitters(pub(crate) bool);

impl HideEmitters {
    /// The rule for a path of `depth` edges: only the camera ray ignores emitters.
    #[inline(always)]
    pub(crate) fn at_depth(self, depth: u32) -> Self {
        Self(self.0 && depth == 0)
    }

    /// Whether rays pass through this surface.
    #[inline(always)]
    pub(crate) fn hides(self, scene: &Scene, surface: &SurfaceInteraction) -> bool {
        self.0 && scene.emitter_of(surface).is_some()
    }
}
