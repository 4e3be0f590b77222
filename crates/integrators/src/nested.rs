//! An integrator nested in another one: its name and its channels.

use crate::integrator::{CameraRay, Integrator, Radiance, Start};
use crate::watch::Watch;
use etendue_sampling::Sampler;
use etendue_scene::Scene;

/// An integrator nested in another one.
pub struct Nested {
    /// Its name in the scene: the prefix of its channels.
    pub name: String,
    /// The integrator.
    pub integrator: Box<dyn Integrator>,
}

impl Nested {
    /// The names of its channels, each prefixed with its name.
    pub(crate) fn channel_names(&self) -> impl Iterator<Item = String> + '_ {
        self.integrator.channels().iter().map(|channel| format!("{}.{channel}", self.name))
    }

    /// Takes a sample of each ray; the nested integrator's channels fill the next columns of
    /// `rows`.
    pub(crate) fn sample_batch(
        &self,
        scene: &Scene,
        rays: &mut [CameraRay],
        rows: &mut Rows<'_>,
        watch: &Watch<'_>,
    ) -> Vec<Radiance> {
        let columns = self.integrator.channels().len();
        let mut channels = vec![0.0; columns * rays.len()];
        let mut radiance = Vec::with_capacity(rays.len());
        self.integrator.sample_batch(scene, rays, &mut channels, watch, &mut radiance);
        rows.append(columns, |row| &channels[row * columns..(row + 1) * columns]);
        radiance
    }
}

/// The channels of many samples: one row per sample, filled from the left.
pub(crate) struct Rows<'a> {
    values: &'a mut [f32],
    width: usize,
    filled: usize,
}

impl<'a> Rows<'a> {
    /// Empty rows of `width` values, stored consecutively.
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

    /// The unfilled rest of each row.
    pub(crate) fn rest(&mut self) -> impl Iterator<Item = &mut [f32]> {
        let filled = self.filled;
        self.values.chunks_exact_mut(self.width.max(1)).map(move |row| &mut row[filled..])
    }
}

/// Takes one sample with an integrator that takes them in batches.
pub(crate) fn sample_alone(
    integrator: &impl Integrator,
    scene: &Scene,
    start: &Start,
    sampler: &mut Sampler,
    (channels, watch): (&mut [f32], &Watch<'_>),
) -> Radiance {
    let mut rays = [CameraRay { start: *start, sampler: *sampler }];
    let mut radiance = Vec::with_capacity(1);
    integrator.sample_batch(scene, &mut rays, channels, watch, &mut radiance);
    let [CameraRay { sampler: rest, .. }] = rays;
    *sampler = rest;
    radiance.pop().unwrap_or(Radiance::NONE)
}

/// Writes values to the front of `channels` and returns the rest.
pub(crate) fn write<'a>(channels: &'a mut [f32], values: &[f32]) -> &'a mut [f32] {
    let (own, rest) = channels.split_at_mut(values.len());
    own.copy_from_slice(values);
    rest
}
