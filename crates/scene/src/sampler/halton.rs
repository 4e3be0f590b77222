//! `halton`: Halton's sequence.

use crate::manual::Manual;
use etendue_document::Parameters;
use etendue_sampling::{SamplerKind, SamplerSpec};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Halton's sequence with scrambled digits: each dimension counts in a prime base \
              of its own. Any count of samples is a good one.",
    parameters: &[super::SAMPLE_COUNT, super::SEED, super::SCRAMBLE],
    sample: r#"<sampler type="halton"><integer name="sample_count" value="64"/></sampler>"#,
};

/// Reads the sampler.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<SamplerSpec> {
    parameters.optional_integer("scramble");
    Some(super::read(parameters, SamplerKind::Halton))
}
