//! The library user's options.

/// Options about light transport that override the scene.
#[derive(Clone, Debug)]
pub struct IntegratorOptions {
    /// The XML `type` of an integrator to use instead of the scene's, with the scene's parameters.
    pub name: Option<String>,
    /// Whether emitters are sampled; otherwise paths find light only by hitting emitters.
    pub emitter_sampling: bool,
    /// The limit of indirect light, as the parameter `clamp_indirect` of path tracers.
    pub clamp_indirect: Option<f32>,
}

impl Default for IntegratorOptions {
    fn default() -> Self {
        Self { name: None, emitter_sampling: true, clamp_indirect: None }
    }
}
