//! `box`: a sample counts only for the pixel that contains it.

use super::{Profile, ReconstructionFilter};
use crate::manual::Manual;
use etendue_document::Parameters;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The box filter: the mean over the pixel's square. The fastest to understand, and the \
              one that keeps neighbouring pixels independent, but edges show steps.",
    parameters: &[],
    sample: r#"<rfilter type="box"/>"#,
};

/// One inside the pixel, zero elsewhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoxFilter;

/// Reads the filter, which has no parameters.
#[must_use]
pub fn build(_parameters: &Parameters<'_>) -> Option<ReconstructionFilter> {
    Some(ReconstructionFilter::new(BoxFilter.into()))
}

impl BoxFilter {
    pub(super) fn radius(self) -> f32 {
        0.5
    }

    pub(super) fn eval(self, _distance: f32) -> f32 {
        1.0
    }
}

impl From<BoxFilter> for Profile {
    fn from(filter: BoxFilter) -> Self {
        Self::Box(filter)
    }
}
