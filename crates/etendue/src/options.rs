//! What a user decides over what the scene file says.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use etendue_engine::Region;
use etendue_integrators::IntegratorOptions;
use etendue_render::BuildOptions;

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
    /// Whether an unknown parameter is an error rather than a warning.
    pub strict: bool,
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
    /// The sample indices to take, as a part of a picture of that many samples; `None` for all.
    pub samples: Option<Range<u32>>,
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
