//! `stratified`: one sample per cell of a grid.

use crate::manual::Manual;
use etendue_document::Parameters;
use etendue_sampling::{SamplerKind, SamplerSpec};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "One random sample in each cell of a square grid, per pair of dimensions. The \
              count is rounded up to a square.",
    parameters: &[super::SAMPLE_COUNT, super::SEED, super::JITTER],
    sample: r#"<sampler type="stratified"><integer name="sample_count" value="64"/></sampler>"#,
};

/// Reads the sampler.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<SamplerSpec> {
    super::read_jitter(parameters);
    Some(super::read(parameters, SamplerKind::Stratified))
}
