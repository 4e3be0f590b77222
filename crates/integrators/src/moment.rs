//! `moment`: the results of other integrators, and their squares.

use crate::{Integrator, Radiance, Start};
use etendue_math::Ray;
use etendue_render::{Manual, Scene};
use etendue_sampling::SampleStream;

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "Renders with the integrators nested in it, and records for each, beside its colour, the \
              square of every sample: `NAME.R` and `m2_NAME.R`, and so on, where NAME is the nested \
              integrator's. The variance of a sample is m2 − mean².",
    parameters: &[],
    sample: r#"<integrator type="moment"><integrator type="path" name="img"/></integrator>"#,
};

/// Records second moments.
pub struct Moment {
    nested: Vec<Box<dyn Integrator>>,
    layers: Vec<String>,
}

impl Moment {
    /// Records the moments of `nested`, by name.
    #[must_use]
    pub fn new(nested: Vec<(String, Box<dyn Integrator>)>) -> Self {
        let channels = |prefix: &str| -> Vec<String> {
            let names = nested.iter().map(|(name, _)| name);
            names.flat_map(|name| ["R", "G", "B"].map(|c| format!("{prefix}{name}.{c}"))).collect()
        };
        let layers = [channels(""), channels("m2_")].concat();
        Self { nested: nested.into_iter().map(|(_, integrator)| integrator).collect(), layers }
    }
}

impl Integrator for Moment {
    fn layers(&self) -> &[String] {
        &self.layers
    }

    fn sample(
        &self,
        scene: &Scene,
        ray: &Ray,
        stream: &mut SampleStream,
        layers: &mut [f32],
    ) -> Radiance {
        self.sample_within(scene, &Start { ray: *ray, medium: None }, stream, layers)
    }

    fn sample_within(
        &self,
        scene: &Scene,
        start: &Start,
        stream: &mut SampleStream,
        layers: &mut [f32],
    ) -> Radiance {
        let (values, squares) = layers.split_at_mut(3 * self.nested.len());
        let mut first = None;
        for (index, integrator) in self.nested.iter().enumerate() {
            // Layers of nested integrators are not recorded.
            let mut ignored = vec![0.0; integrator.layers().len()];
            let radiance = integrator.sample_within(scene, start, stream, &mut ignored);
            for (channel, value) in radiance.color.rgb().into_iter().enumerate() {
                values[3 * index + channel] = value;
                squares[3 * index + channel] = value * value;
            }
            first.get_or_insert(radiance);
        }
        first.unwrap_or(Radiance::NONE)
    }
}
