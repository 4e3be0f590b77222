//! `ldsampler`: blocks of the (0, 2)-sequence.

use crate::manual::{Manual, parameter};
use etendue_document::Parameters;
use etendue_sampling::{SamplerKind, SamplerSpec};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The (0, 2)-sequence in base 2, shuffled and scrambled for each pair of \
              dimensions (Kollig and Keller, \"Efficient Multidimensional Sampling\", 2002). \
              The count is rounded up to a power of two.",
    parameters: &[
        super::SAMPLE_COUNT,
        super::SEED,
        parameter(
            "dimension",
            "integer",
            "4",
            "Accepted and without effect: all dimensions are of the sequence.",
        ),
    ],
    sample: r#"<sampler type="ldsampler"><integer name="sample_count" value="64"/></sampler>"#,
};

/// Reads the sampler.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<SamplerSpec> {
    parameters.optional_integer("dimension");
    Some(super::read(parameters, SamplerKind::LowDiscrepancy))
}
