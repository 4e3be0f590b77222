//! `sobol`: Sobol's sequence.

use crate::manual::Manual;
use etendue_document::Parameters;
use etendue_sampling::{SamplerKind, SamplerSpec};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Sobol's sequence, shuffled and Owen-scrambled for each pair of dimensions \
              (Burley, \"Practical Hash-based Owen Scrambling\", 2020). Best at powers of two, \
              good at any count; the one to choose when in doubt.",
    parameters: &[super::SAMPLE_COUNT, super::SEED, super::SCRAMBLE],
    sample: r#"<sampler type="sobol"><integer name="sample_count" value="64"/></sampler>"#,
};

/// Reads the sampler.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<SamplerSpec> {
    parameters.optional_integer("scramble");
    Some(super::read(parameters, SamplerKind::Sobol))
}
