//! What the user of the library decides.

/// What the user of the library decides about how light is computed, over what the scene says.
#[derive(Clone, Debug)]
pub struct IntegratorOptions {
    /// Another integrator than the scene's, by its XML `type`, with the scene's parameters.
    pub name: Option<String>,
    /// Whether emitters are sampled; without, light is found by chance alone.
    pub emitter_sampling: bool,
}

impl Default for IntegratorOptions {
    fn default() -> Self {
        Self { name: None, emitter_sampling: true }
    }
}
