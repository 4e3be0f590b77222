//! `catmullrom`: the interpolating cubic.

use super::mitchell::Mitchell;
use super::{Profile, ReconstructionFilter};
use crate::manual::Manual;
use etendue_document::Parameters;

/// The manual page.
pub const MANUAL: Manual = Manual {
    summary: "The Catmull-Rom spline: the `mitchell` filter with B = 0 and C = 1/2. Sharp, with \
              more ringing.",
    parameters: &[],
    sample: r#"<rfilter type="catmullrom"/>"#,
};

/// Mitchell and Netravali's cubic with B = 0 and C = 1/2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CatmullRom;

const CUBIC: Mitchell = Mitchell::new(0.0, 0.5);

/// Reads the filter, which has no parameters.
#[must_use]
pub fn build(_parameters: &Parameters<'_>) -> Option<ReconstructionFilter> {
    Some(ReconstructionFilter::new(CatmullRom.into()))
}

impl CatmullRom {
    pub(super) fn radius(self) -> f32 {
        CUBIC.radius()
    }

    pub(super) fn eval(self, distance: f32) -> f32 {
        CUBIC.eval(distance)
    }
}

impl From<CatmullRom> for Profile {
    fn from(filter: CatmullRom) -> Self {
        Self::CatmullRom(filter)
    }
}
