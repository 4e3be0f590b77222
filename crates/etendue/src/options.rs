//! What a user decides over what the scene file says.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use etendue_engine::Region;
use etendue_integrators::IntegratorOptions;
use etendue_scene::BuildOptions;

/// How a scene file becomes a scene.
#[derive(Clone, Debug, Default)]
pub struct SceneOptions {
    /// Values for `$name`, over the scene's own defaults.
    pub defines: Vec<(String, String)>,
    /// Folders in which files are looked for, beside the scene's own.
    pub search_paths: Vec<PathBuf>,
    /// Film, filter, and what to do about missing files.
    pub build: BuildOptions,
    /// How light is computed.
    pub integrator: IntegratorOptions,
    /// Whether unknown parameters are errors rather than warnings.
    pub strict: bool,
    /// Whether the scene keeps its document, and what it was made of, for quick
    /// [edits](crate::LoadedScene::edited). Without, the document makes room before the tree is built.
    pub editable: bool,
}

/// How a scene is rendered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderOptions {
    /// Which of the scene's cameras.
    pub sensor: SensorChoice,
    /// The part of the camera's film that is rendered, instead of the part that the scene says.
    pub region: Option<Region>,
    /// Samples for every pixel; if neither this nor a time is given, what the scene's sampler says.
    pub samples_per_pixel: Option<u32>,
    /// Which of the samples to take, as a part of a picture; `None` for all.
    pub samples: Option<SampleChoice>,
    /// How many samples the sampler spreads, where they are more or fewer than are taken: a render
    /// that goes on keeps the plan that it began with.
    pub planned_samples: Option<u32>,
    /// Wall time from the first ray; with a number of samples too, what comes first ends it.
    pub time_limit: Option<Duration>,
    /// Chooses the random numbers; `None` for the seed of the scene's sampler.
    pub seed: Option<u64>,
    /// `None` for one per processor. The picture does not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Whether the variance of every pixel's mean is added, as the layers `variance.R`, `.G`, `.B`.
    pub variance: bool,
    /// The bytes of memory that the film may take; `None` for [`DEFAULT_MEMORY_LIMIT`].
    pub memory_limit: Option<u64>,
}

/// What a film may take where nobody says otherwise: 16 GiB.
pub const DEFAULT_MEMORY_LIMIT: u64 = 16 << 30;

/// Which of a scene's cameras.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SensorChoice {
    /// By its place in the file, from 0.
    Index(usize),
    /// By its `id`.
    Id(String),
}

/// Which of the samples that every pixel is planned to have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SampleChoice {
    /// Those with these indices.
    Indices(Range<u32>),
    /// One of so many parts of nearly the same size.
    Part {
        /// Which one, from 1.
        number: u32,
        /// How many there are.
        count: u32,
    },
}

impl SampleChoice {
    /// The indices; empty where there are more parts than samples.
    #[must_use]
    pub fn indices(&self, planned: u32) -> Range<u32> {
        match self {
            Self::Indices(indices) => indices.clone(),
            Self::Part { number, count } => {
                // Below `planned` as long as the number is at most the count.
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
    /// The first one.
    fn default() -> Self {
        Self::Index(0)
    }
}

impl From<&str> for SensorChoice {
    /// A number is a place in the file, everything else an `id`.
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
