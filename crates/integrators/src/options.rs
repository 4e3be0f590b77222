//! The library user's options.

/// Options about light transport that override the scene.
#[derive(Clone, Debug)]
pub struct IntegratorOptions {
    /// The XML `type` of an integrator to use instead of the scene's, with the scene's parameters.
    pub name: Option<String>,
    /// Whether emitters are sampled; otherwise paths find light only by hitting emitters.
    pub emitter_sampling: bool,
}

impl Default for IntegratorOptions {
    fn default() -> Self {
        Self { name: None, emitter_sampling: true }
    }
}
