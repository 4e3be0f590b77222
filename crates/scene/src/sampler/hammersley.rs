//! `hammersley`: Hammersley's point set.

use crate::manual::Manual;
use etendue_document::Parameters;
use etendue_sampling::{SamplerKind, SamplerSpec};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Hammersley's point set for each pair of dimensions, scrambled: evenly spread \
              for the count that is asked for.",
    parameters: &[super::SAMPLE_COUNT, super::SEED, super::SCRAMBLE],
    sample: r#"<sampler type="hammersley"><integer name="sample_count" value="64"/></sampler>"#,
};

/// Reads the sampler.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<SamplerSpec> {
    parameters.optional_integer("scramble");
    Some(super::read(parameters, SamplerKind::Hammersley))
}
