//! `multijitter`: a grid whose projections are grids as well.

use crate::manual::Manual;
use etendue_document::Parameters;
use etendue_sampling::{SamplerKind, SamplerSpec};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Correlated multi-jittered samples (Kensler, \"Correlated Multi-Jittered \
              Sampling\", 2013): stratified over the square and along each axis. The count is \
              rounded up to a product.",
    parameters: &[super::SAMPLE_COUNT, super::SEED, super::JITTER],
    sample: r#"<sampler type="multijitter"><integer name="sample_count" value="64"/></sampler>"#,
};

/// Reads the sampler.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<SamplerSpec> {
    super::read_jitter(parameters);
    Some(super::read(parameters, SamplerKind::Multijitter))
}
