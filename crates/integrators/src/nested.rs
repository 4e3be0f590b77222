//! An integrator inside another one: its name, and its place among the layers.

use crate::{CameraRay, Integrator, Radiance, Start};
use etendue_sampling::Sampler;
use etendue_scene::Scene;

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

    /// Takes a sample of each ray; the integrator's own layers become the next columns of `rows`.
    pub(crate) fn sample_batch(
        &self,
        scene: &Scene,
        rays: &mut [CameraRay],
        rows: &mut Rows<'_>,
    ) -> Vec<Radiance> {
        let columns = self.integrator.layers().len();
        let mut layers = vec![0.0; columns * rays.len()];
        let mut radiance = Vec::with_capacity(rays.len());
        self.integrator.sample_batch(scene, rays, &mut layers, &mut radiance);
        rows.append(columns, |row| &layers[row * columns..(row + 1) * columns]);
        radiance
    }
}

/// The layers of many samples: a row for each, filled from the left.
pub(crate) struct Rows<'a> {
    values: &'a mut [f32],
    width: usize,
    filled: usize,
}

impl<'a> Rows<'a> {
    /// Empty rows of `width` values, one after the other.
    pub(crate) fn new(values: &'a mut [f32], width: usize) -> Self {
        Self { values, width, filled: 0 }
    }

    /// Fills the next columns of every row.
    pub(crate) fn append<V: AsRef<[f32]>>(&mut self, columns: usize, values: impl Fn(usize) -> V) {
        if columns == 0 {
            return;
        }
        for (index, row) in self.values.chunks_exact_mut(self.width).enumerate() {
            row[self.filled..self.filled + columns].copy_from_slice(values(index).as_ref());
        }
        self.filled += columns;
    }

    /// What is not yet filled of each row.
    pub(crate) fn rest(&mut self) -> impl Iterator<Item = &mut [f32]> {
        let filled = self.filled;
        self.values.chunks_exact_mut(self.width.max(1)).map(move |row| &mut row[filled..])
    }
}

/// One sample, by an integrator that takes them in batches.
pub(crate) fn sample_alone(
    integrator: &impl Integrator,
    scene: &Scene,
    start: &Start,
    stream: &mut Sampler,
    layers: &mut [f32],
) -> Radiance {
    let mut rays = [CameraRay { start: *start, stream: *stream }];
    let mut radiance = Vec::with_capacity(1);
    integrator.sample_batch(scene, &mut rays, layers, &mut radiance);
    let [CameraRay { stream: rest, .. }] = rays;
    *stream = rest;
    radiance.pop().unwrap_or(Radiance::NONE)
}

/// Writes values to the first of `layers` and returns the rest.
pub(crate) fn write<'a>(layers: &'a mut [f32], values: &[f32]) -> &'a mut [f32] {
    let (own, rest) = layers.split_at_mut(values.len());
    own.copy_from_slice(values);
    rest
}
