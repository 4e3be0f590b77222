//! `moment`: the results of other integrators and their squares.

use crate::integrator::{CameraRay, ChannelKind, Integrator, Radiance, Start};
use crate::nested::{Nested, Rows, sample_alone};
use crate::watch::Watch;
use etendue_sampling::Sampler;
use etendue_scene::{Manual, Scene};
use etendue_spectrum::color::rgb_to_xyz;

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "Renders with the integrators nested in it, and records the mean and the mean square of \
              everything that they say of a sample. For an integrator NAME (`_arg_0`, `_arg_1`, … for those \
              without a name) the layers are `NAME.X`, `NAME.Y` and `NAME.Z`, its colour in CIE XYZ, its \
              own layers as `NAME.LAYER`, and for each of these another one, with `m2_` before it, of \
              the squares. The variance of a sample is m2 − mean². The picture is that of the first.",
    parameters: &[],
    sample: r#"<integrator type="moment"><integrator type="path" name="img"/></integrator>"#,
};

/// Records second moments.
pub struct Moment {
    nested: Vec<Nested>,
    channels: Vec<String>,
}

impl Moment {
    /// Records the moments of `nested`, by name.
    #[must_use]
    pub fn new(nested: Vec<Nested>) -> Self {
        let mut channels: Vec<String> = Vec::new();
        for nested in &nested {
            channels.extend(nested.channel_names());
            channels.extend(["X", "Y", "Z"].map(|channel| format!("{}.{channel}", nested.name)));
        }
        let squares: Vec<String> = channels.iter().map(|channel| format!("m2_{channel}")).collect();
        channels.extend(squares);
        Self { nested, channels }
    }
}

impl Integrator for Moment {
    fn channels(&self) -> &[String] {
        &self.channels
    }

    fn channel_kinds(&self) -> Vec<ChannelKind> {
        let mut kinds = Vec::with_capacity(self.channels.len());
        for nested in &self.nested {
            kinds.extend(nested.integrator.channel_kinds());
            kinds.extend([ChannelKind::Mean; 3]);
        }
        // The squares of identifiers are as little use as their means.
        kinds.resize(self.channels.len(), ChannelKind::Mean);
        kinds
    }

    fn needs_light(&self) -> bool {
        self.nested.iter().any(|nested| nested.integrator.needs_light())
    }

    fn clamp_indirect(&self) -> Option<f32> {
        self.nested.iter().find_map(|nested| nested.integrator.clamp_indirect())
    }

    fn sample(
        &self,
        scene: &Scene,
        start: &Start,
        sampler: &mut Sampler,
        channels: &mut [f32],
        watch: &Watch<'_>,
    ) -> Radiance {
        sample_alone(self, scene, start, sampler, (channels, watch))
    }

    fn sample_batch(
        &self,
        scene: &Scene,
        rays: &mut [CameraRay],
        channels: &mut [f32],
        watch: &Watch<'_>,
        radiance: &mut Vec<Radiance>,
    ) {
        let width = self.channels.len();
        let mut rows = Rows::new(channels, width);
        let mut first = None;
        for nested in &self.nested {
            let seen = nested.sample_batch(scene, rays, &mut rows, watch);
            rows.append(3, |row| rgb_to_xyz(seen[row].color.rgb()));
            first.get_or_insert(seen);
        }
        for row in channels.chunks_exact_mut(width.max(1)) {
            let (values, squares) = row.split_at_mut(width / 2);
            for (square, value) in squares.iter_mut().zip(values) {
                *square = *value * *value;
            }
        }
        radiance.extend(first.unwrap_or_else(|| vec![Radiance::NONE; rays.len()]));
    }
}
