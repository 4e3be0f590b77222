//! `orthogonal`: stratified in every pair of dimensions.

use crate::manual::{Manual, parameter};
use etendue_document::{Fault, Parameters};
use etendue_sampling::{SamplerKind, SamplerSpec};

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "Samples from orthogonal arrays (Jarosz et al., \"Orthogonal Array Sampling for \
              Monte Carlo Rendering\", 2019): stratified over pairs of dimensions that do not \
              lie side by side too. The count is rounded up to the square of a prime.",
    parameters: &[
        super::SAMPLE_COUNT,
        super::SEED,
        super::JITTER,
        parameter(
            "strength",
            "integer",
            "2",
            "Accepted; the strength is 2, with a warning where this is not.",
        ),
    ],
    sample: r#"<sampler type="orthogonal"><integer name="sample_count" value="64"/></sampler>"#,
};

/// Reads the sampler.
#[must_use]
pub fn build(parameters: &Parameters<'_>) -> Option<SamplerSpec> {
    super::read_jitter(parameters);
    if parameters.integer("strength", 2) != 2 {
        let message = "the arrays are of strength 2 all the same";
        parameters.warning(Fault::Approximation, "strength", message);
    }
    Some(super::read(parameters, SamplerKind::Orthogonal))
}
