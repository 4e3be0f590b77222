//! The seam between the driver and whatever it renders: samples by name.

use etendue_integrators::{ChannelKind, Watch};
use etendue_spectrum::Spectrum;

use crate::splats::PixelSplat;

/// A source of samples that are named by pixel and index, shared by all threads.
///
/// This is all that the driver and the film know of what they render. A [`crate::Camera`] is the
/// source that a scene is: it turns each name into a ray, asks the
/// [`Integrator`](etendue_integrators::Integrator) for the light along it, and applies sensor and
/// filter. An integrator knows rays and no pixels; a source knows pixels and no rays, so that the
/// driver can be tested on formulas.
///
/// # Contract
/// - A sample is a pure function of its id: whatever was asked before, and however ids are divided
///   into batches, it has the same bits.
/// - Samples that take long ask the [`Watch`] whether they are still wanted. If it abandons them, they
///   are meaningless, and the caller discards the whole batch.
pub trait SampleSource: Sync {
    /// The names of the channels beside colour and alpha, such as `albedo.R`.
    fn channels(&self) -> &[String];

    /// How the values of each channel are combined.
    fn channel_kinds(&self) -> Vec<ChannelKind> {
        vec![ChannelKind::Mean; self.channels().len()]
    }

    /// Takes a sample for each id, in order, and appends them to `samples`.
    ///
    /// `channels` has a value for each of [`Self::channels`] of each sample, sample after sample. They
    /// come with any content, and each is overwritten.
    fn take_samples(
        &self,
        ids: &[SampleId],
        channels: &mut [f32],
        watch: &Watch<'_>,
        samples: &mut Vec<Sample>,
    );

    /// Whether light may be negative in some channel. Otherwise such samples are defects.
    fn is_out_of_gamut(&self) -> bool {
        false
    }

    /// The splats that belong to the samples, if there are any.
    fn splats(&self) -> Option<&dyn SplatSource> {
        None
    }
}

/// A source of light that lands anywhere on the film, under the names of samples.
///
/// # Contract
/// - The splats of a sample are a pure function of its id.
/// - The mean of the splats over all samples of the film is added to the picture.
pub trait SplatSource: Sync {
    /// Gives the splats of one sample to `sink`. If the watch abandons them, they must be discarded.
    fn trace_splats(&self, id: SampleId, watch: &Watch<'_>, sink: &mut PixelSplatSink<'_>);
}

/// Takes the splats of a sample.
pub type PixelSplatSink<'a> = dyn FnMut(PixelSplat) + 'a;

/// How many samples a source is asked for at once: enough to find many alike among them, few enough
/// that what it keeps of them, some 300 bytes each, stays in the caches of one core. From 256 to 1024
/// renders gain 3 %, from there to 2048 another 1 to 2 %, and with 4096 nothing more.
pub(crate) const BATCH_SIZE: usize = 2048;

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

/// What one sample adds to its pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The radiance that arrives at the sensor, times the sensor's response.
    pub color: Spectrum,
    /// How much of the background is covered: 1 where something was hit.
    pub alpha: f32,
    /// The reconstruction filter's weight, of mean 1; negative where the filter is.
    pub weight: f32,
    /// The squared distance from the pixel's centre, in pixels. It decides whose identifiers the pixel
    /// gets.
    pub squared_distance: f32,
}
