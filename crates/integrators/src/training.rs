//! The contract of training: what an integrator learns before it renders.

use crate::{CameraRay, Integrator};
use etendue_scene::Scene;

/// Learns from camera samples, pass by pass, and becomes the integrator that renders the picture.
///
/// Every pass takes samples over the whole film with what the passes before it have learned, and
/// sums up what they show. Between passes, [`Self::refine`] turns the sums into what the next pass
/// uses. The samples of a training are not part of the picture.
///
/// # Contract
/// - The result is a function of the scene, the sensor, the sampler and the integrator, bit for bit.
///   It does not depend on threads, on the part of the film that is rendered, or on which of its
///   samples are. Every part of a divided render and every resumed run repeats the same training, so
///   checkpoints stay valid and parts may be merged.
/// - [`Self::learn`] runs on many threads at once, with any division of a pass into batches. Its
///   sums must not depend on the order of what is added: they are integers, atomic or behind a lock.
pub trait Training: Send + Sync {
    /// How many samples each pass gives every pixel. It does not change while training goes on.
    fn samples_of_passes(&self) -> &[u32];

    /// Takes camera samples with what earlier passes have learned, and adds up what they show.
    fn learn(&self, scene: &Scene, rays: &mut [CameraRay]);

    /// Ends a pass: turns its sums into what later samples use.
    fn refine(&mut self);

    /// Ends the training; the integrator has no training left.
    fn finish(self: Box<Self>) -> Box<dyn Integrator>;
}
