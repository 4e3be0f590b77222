//! `hide_emitters`: the camera does not see emitters.

use super::alpha::Alpha;
use etendue_scene::{Scene, SurfaceInteraction};

/// Whether rays pass through emitters: with `hide_emitters`, camera rays do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HideEmitters(pub(crate) bool);

impl HideEmitters {
    /// The rule for a path with this alpha: only the camera ray ignores emitters, also behind
    /// surfaces that it passes straight through.
    #[inline(always)]
    pub(crate) fn seen_by(self, alpha: Alpha) -> Self {
        Self(self.0 && alpha.is_camera_ray())
    }

    /// Whether rays pass through this surface.
    #[inline(always)]
    pub(crate) fn hides(self, scene: &Scene, surface: &SurfaceInteraction) -> bool {
        self.0 && scene.emitter_of(surface).is_some()
    }
}
