//! An integrator inside another one: its name, and its place among the layers.

use crate::{Integrator, Radiance, Start};
use etendue_render::Scene;
use etendue_sampling::SampleStream;

/// A nested integrator.
pub(crate) struct Nested {
    /// What the scene calls it: the prefix of its layers.
    pub(crate) name: String,
    pub(crate) integrator: Box<dyn Integrator>,
}

impl Nested {
    /// The names of its own layers, each behind its name.
    pub(crate) fn layer_names(&self) -> impl Iterator<Item = String> + '_ {
        self.integrator.layers().iter().map(|layer| format!("{}.{layer}", self.name))
    }

    /// Takes a sample, lets it fill the first of `layers`, and returns the rest of them.
    pub(crate) fn sample<'a>(
        &self,
        scene: &Scene,
        start: &Start,
        stream: &mut SampleStream,
        layers: &'a mut [f32],
    ) -> (Radiance, &'a mut [f32]) {
        let (own, rest) = layers.split_at_mut(self.integrator.layers().len());
        (self.integrator.sample_within(scene, start, stream, own), rest)
    }
}

/// Writes values to the first of `layers` and returns the rest.
pub(crate) fn write<'a>(layers: &'a mut [f32], values: &[f32]) -> &'a mut [f32] {
    let (own, rest) = layers.split_at_mut(values.len());
    own.copy_from_slice(values);
    rest
}
