//! Where samples come from: the seam between scheduling and light transport.

use etendue_spectrum::Spectrum;

use crate::Splat;

/// Names one sample of a picture. With the seed, it decides everything about the sample.
///
/// The order is that of rendering: by sample index, then down the picture, then along the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SampleId {
    /// Which of the pixel's samples, from 0.
    pub index: u32,
    /// The row in the whole film, from 0 at the top.
    pub y: u32,
    /// The column in the whole film, from 0 at the left.
    pub x: u32,
}

/// What one sample says about its pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The radiance that arrives at the sensor, times the sensor's response.
    pub color: Spectrum,
    /// How much of the background is covered: 1 where something was hit.
    pub alpha: f32,
    /// The reconstruction filter's weight, of mean 1; negative where the filter is.
    pub weight: f32,
}

/// A pure function from sample names to samples, shared by all threads.
///
/// # Contract
/// - The same id gives the same sample, bit for bit, whatever was asked before.
/// - `layers` comes in with as many values as there are names in [`SampleSource::layers`], of any
///   content, and every one is written.
pub trait SampleSource: Sync {
    /// The names of the extra layers, such as `albedo.R`.
    fn layers(&self) -> &[String];

    /// Takes one sample.
    fn sample(&self, id: SampleId, layers: &mut [f32]) -> Sample;

    /// Takes many samples, as [`Self::sample`] takes each, and appends them to `samples`. `layers`
    /// has the places of all of them, one after the other.
    fn sample_batch(&self, ids: &[SampleId], layers: &mut [f32], samples: &mut Vec<Sample>) {
        let layer_count = self.layers().len();
        samples.extend(ids.iter().enumerate().map(|(index, &id)| {
            self.sample(id, &mut layers[index * layer_count..(index + 1) * layer_count])
        }));
    }

    /// Whether samples leave splats, too.
    fn has_splats(&self) -> bool {
        false
    }

    /// Hands over what the sample leaves anywhere on the film.
    fn splat(&self, _id: SampleId, _add: &mut dyn FnMut(Splat)) {}
}
