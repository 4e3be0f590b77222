//! `independent`: uncorrelated random numbers.

use crate::manual::Manual;
use etendue_document::Parameters;
use etendue_sampling::{SamplerKind, SamplerSpec};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Independent random numbers: the slowest to converge, and the plainest. The \
              default where a sensor has no sampler.",
    parameters: &[super::SAMPLE_COUNT, super::SEED],
    sample: r#"<sampler type="independent"><integer name="sample_count" value="64"/></sampler>"#,
};

/// Reads the sampler.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<SamplerSpec> {
    Some(super::read(parameters, SamplerKind::Independent))
}
