//! `volpathmis`: path tracing through media whose extinction differs between colour channels.

use crate::media::Heuristic;
use crate::options::IntegratorOptions;
use crate::volpath::{PARAMETERS, VolumePath};
use etendue_document::Parameters;
use etendue_scene::Manual;

/// The manual page.
pub(crate) const MANUAL: Manual = Manual {
    summary: "As `volpath`, but light found by chance and light sampled on emitters are weighed by the \
              densities of whole paths, with all their collisions, for every colour that could have \
              led to them (Miller et al. 2019), where `volpath` compares the densities of the last \
              direction. It has less noise where extinction differs strongly between colours.",
    parameters: &PARAMETERS,
    sample: r#"<integrator type="volpathmis"><integer name="max_depth" value="8"/></integrator>"#,
};

/// Reads `volpathmis`.
pub(crate) fn build(parameters: &Parameters<'_>, options: &IntegratorOptions) -> VolumePath {
    VolumePath::with_heuristic(parameters, options, Heuristic::Paths)
}
