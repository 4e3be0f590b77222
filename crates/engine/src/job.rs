//! What to render, and how much of it.

use std::time::Duration;

use crate::error::EngineError;
use crate::region::Region;

/// What to render, apart from the scene.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// The pixels.
    pub region: Region,
    /// The index of every pixel's first sample: 0, unless this is a part of a picture whose other
    /// samples are taken elsewhere.
    pub first_sample: u32,
    /// When to stop.
    pub budget: Budget,
    /// Whether the film keeps what variances need. The source's samples with even index must then be
    /// independent of those with odd index
    /// ([`SamplerSpec::in_halves`](etendue_sampling::SamplerSpec::in_halves)).
    pub variance: bool,
    /// The most bytes that the film may take.
    pub memory_limit: u64,
}

/// How much is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Every pixel gets the samples with an index below this number; `None` for as many as the time
    /// allows.
    pub samples_per_pixel: Option<u32>,
    /// Wall time from the first ray. Every pixel gets one sample even if that takes longer, unless
    /// the path of that sample is extremely long.
    pub time: Option<Duration>,
}

impl Budget {
    /// Checks that there is something to spend, and an end to it.
    pub(crate) fn check(&self) -> Result<(), EngineError> {
        match (self.samples_per_pixel, self.time) {
            (Some(0), _) | (None, None) => Err(EngineError::NoBudget),
            _ => Ok(()),
        }
    }
}
