//! The user's choices that override the scene file.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use etendue_engine::Region;
use etendue_image::ToneMap;
use etendue_integrators::IntegratorOptions;
use etendue_scene::BuildOptions;

/// How a scene file becomes a scene.
#[derive(Clone, Debug, Default)]
pub struct SceneOptions {
    /// Values for `$name`, which override the scene's defaults.
    pub defines: Vec<(String, String)>,
    /// Additional folders in which files are looked up.
    pub search_paths: Vec<PathBuf>,
    /// Film, filter, and the handling of missing files.
    pub build: BuildOptions,
    /// Options of the integrators.
    pub integrator: IntegratorOptions,
    /// Whether unknown parameters are errors rather than warnings.
    pub strict: bool,
    /// Whether plugins that nobody knows are replaced by the plainest of their family, with a
    /// warning each; emitters, shapes and media among them are left out. Otherwise they are errors.
    pub lenient: bool,
    /// Whether the scene keeps its document and intermediate results for quick
    /// [edits](crate::LoadedScene::edited). Otherwise the document is freed before the tree is
    /// built.
    pub editable: bool,
}

/// How a scene is rendered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderOptions {
    /// Which camera of the scene.
    pub sensor: SensorChoice,
    /// The region of the camera's film to render, instead of the scene's.
    pub region: Option<Region>,
    /// Samples per pixel. If neither this nor a time is given, the scene's sampler decides.
    pub samples_per_pixel: Option<u32>,
    /// Which of the samples to take when rendering a part of a picture; `None` for all.
    pub samples: Option<SampleChoice>,
    /// How many samples the sampler distributes, if not as many as are taken: a resumed render
    /// keeps its original plan.
    pub planned_samples: Option<u32>,
    /// Wall time limit, counted from the first ray. With a sample count too, whichever is reached
    /// first ends the render.
    pub time_limit: Option<Duration>,
    /// The seed of the random numbers; `None` for the seed of the scene's sampler.
    pub seed: Option<u64>,
    /// The number of threads; `None` for one per processor. The picture does not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Whether to add the variance of every pixel's mean as the channels `variance.R`, `.G`, `.B`.
    pub variance: bool,
    /// The exposure of sRGB-encoded files in stops, instead of the film's.
    pub exposure: Option<f32>,
    /// The tone mapping of sRGB-encoded files, instead of the film's.
    pub tone_map: Option<ToneMap>,
    /// The name of the scene, for the metadata of pictures; empty for none.
    pub scene_name: String,
    /// The maximum memory of the film in bytes; `None` for [`DEFAULT_MEMORY_LIMIT`].
    pub memory_limit: Option<u64>,
}

/// The default memory limit of the film: 16 GiB.
pub const DEFAULT_MEMORY_LIMIT: u64 = 16 << 30;

/// Selects one of a scene's cameras.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SensorChoice {
    /// By its position in the file, from 0.
    Index(usize),
    /// By its `id`.
    Id(String),
}

/// Selects some of the planned samples per pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SampleChoice {
    /// The samples with these indices.
    Indices(Range<u32>),
    /// One of several parts of nearly equal size.
    Part {
        /// The number of this part, from 1.
        number: u32,
        /// The number of parts.
        count: u32,
    },
}

impl SampleChoice {
    /// The sample indices; empty if there are more parts than samples.
    #[must_use]
    pub fn indices(&self, planned: u32) -> Range<u32> {
        match self {
            Self::Indices(indices) => indices.clone(),
            Self::Part { number, count } => {
                // Below `planned` as long as the part number is at most the part count.
                let end = |number: u32| {
                    let end = u64::from(planned) * u64::from(number) / u64::from((*count).max(1));
                    u32::try_from(end).unwrap_or(u32::MAX)
                };
                end(number.saturating_sub(1))..end(*number)
            }
        }
    }
}

impl Default for SensorChoice {
    /// The first camera.
    fn default() -> Self {
        Self::Index(0)
    }
}

impl From<&str> for SensorChoice {
    /// A number is a position in the file; anything else is an `id`.
    fn from(text: &str) -> Self {
        text.parse().map_or_else(|_| Self::Id(text.to_owned()), Self::Index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_make_the_whole_and_are_nearly_equal() {
        for (planned, count) in [(1, 1), (64, 8), (100, 7), (3, 5), (u32::MAX, 1000)] {
            let mut end = 0;
            for number in 1..=count {
                let part = SampleChoice::Part { number, count }.indices(planned);
                assert_eq!(part.start, end);
                let size = part.end - part.start;
                assert!(size == planned / count || size == planned / count + 1);
                end = part.end;
            }
            assert_eq!(end, planned);
        }
    }
}
